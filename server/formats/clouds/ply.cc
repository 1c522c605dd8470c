#include <array>
#include <map>
#include <optional>
#include <set>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/clouds/cloud_decoders.h"
#include "server/formats/clouds/cloud_table.h"
#include "server/formats/clouds/cloud_text.h"

namespace rigcal::formats {
namespace {

constexpr const char* kPlyCure = "Mend the header, or save the cloud again as PLY 1.0.";
constexpr const char* kListCure = "Save the points alone, with scalar properties.";

struct Property {
  std::string name;
  Scalar type = Scalar::kFloat32;
  bool is_list = false;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class PlyBody { kAscii, kLittle, kBig };

struct PlyHeader {
  std::optional<PlyBody> body;
  std::vector<Element> elements;
  std::size_t body_offset_bytes = 0, body_line = 1;
};

std::optional<Scalar> PlyScalarOf(std::string_view name) {
  static const std::map<std::string_view, Scalar> kTypes = {
      {"char", Scalar::kInt8},      {"int8", Scalar::kInt8},       {"uchar", Scalar::kUint8},
      {"uint8", Scalar::kUint8},    {"short", Scalar::kInt16},     {"int16", Scalar::kInt16},
      {"ushort", Scalar::kUint16},  {"uint16", Scalar::kUint16},   {"int", Scalar::kInt32},
      {"int32", Scalar::kInt32},    {"uint", Scalar::kUint32},     {"uint32", Scalar::kUint32},
      {"float", Scalar::kFloat32},  {"float32", Scalar::kFloat32}, {"double", Scalar::kFloat64},
      {"float64", Scalar::kFloat64}};
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

std::optional<PlyBody> BodyOf(std::string_view name) {
  if (name == "ascii") return PlyBody::kAscii;
  if (name == "binary_little_endian") return PlyBody::kLittle;
  if (name == "binary_big_endian") return PlyBody::kBig;
  return std::nullopt;
}

class HeaderReader {
 public:
  explicit HeaderReader(const std::string& name) : name_(name) {}

  Result<PlyHeader> Read(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, limits::kCloudHeaderBytesMax);
    TextLines lines(head);
    if (lines.Next() != "ply") return RefuseCloud(name_, "does not begin with the line \"ply\"", kPlyCure);
    for (bool ended = false; !ended;) {
      if (lines.AtEnd())
        return RefuseCloud(name_,
                           "its header has no end_header line in its first " + std::to_string(head.size()) + " bytes",
                           kPlyCure);
      const auto words = WordsOf(lines.Next());
      line_ = lines.line();
      ended = words.size() == 1 && words[0] == "end_header";
      if (!ended) RIGCAL_TRY(TakeLine(words));
    }
    if (!header_.body) return RefuseCloud(name_, "its header has no format line", kPlyCure);
    header_.body_offset_bytes = head.size() - lines.rest().size();
    header_.body_line = lines.line() + 1;
    return std::move(header_);
  }

 private:
  [[nodiscard]] tl::unexpected<Error> Refuse(const std::string& what) const {
    return RefuseCloud(name_, "line " + std::to_string(line_) + ": " + what, kPlyCure);
  }

  Status TakeLine(const std::vector<std::string_view>& words) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return {};
    if (words[0] == "format") return TakeFormat(words);
    if (words[0] == "element") return TakeElement(words);
    if (words[0] == "property") return TakeProperty(words);
    return Refuse(Quoted(words[0]) + " is no keyword of a PLY header");
  }

  Status TakeFormat(const std::vector<std::string_view>& words) {
    if (header_.body) return Refuse("a second format line");
    if (words.size() != 3 || words[2] != "1.0") return Refuse("this is no format of version 1.0");
    header_.body = BodyOf(words[1]);
    if (!header_.body) return Refuse("format " + Quoted(words[1]) + " is not known");
    return {};
  }

  Status TakeElement(const std::vector<std::string_view>& words) {
    if (words.size() != 3) return Refuse("an element has a name and a count");
    const auto count = CountOf(words[2]);
    if (!count) return Refuse("element " + Quoted(words[1]) + ": " + Quoted(words[2]) + " is not a count");
    if (!names_.insert(words[1]).second) return Refuse("element " + Quoted(words[1]) + " occurs twice");
    header_.elements.push_back({std::string(words[1]), *count, {}});
    return {};
  }

  Status TakeProperty(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) return Refuse("a property before the first element");
    std::vector<Property>& properties = header_.elements.back().properties;
    if (words.size() == 5 && words[1] == "list") {
      properties.push_back({std::string(words[4]), Scalar::kFloat32, true});
      return {};
    }
    if (words.size() != 3) return Refuse("a property has a type and a name");
    const auto type = PlyScalarOf(words[1]);
    if (!type) return Refuse("property " + Quoted(words[2]) + " has the unknown type " + Quoted(words[1]));
    properties.push_back({std::string(words[2]), *type, false});
    return {};
  }

  const std::string& name_;
  std::size_t line_ = 0;
  std::set<std::string_view> names_;
  PlyHeader header_;
};

Status CheckScalar(const std::string& file, const Element& element) {
  for (const Property& property : element.properties)
    if (property.is_list)
      return RefuseCloud(
          file, "property " + Quoted(property.name) + " of element " + Quoted(element.name) + " is a list", kListCure);
  return {};
}

std::size_t BytesOf(const Element& element) {
  std::size_t bytes = 0;
  for (const Property& property : element.properties) bytes += SizeOf(property.type);
  return bytes;
}

// What is left of the body, and the number of its first line.
struct Rest {
  std::string_view body;
  std::size_t line;
};

Status Skip(const std::string& file, const Element& element, bool is_text, Rest& rest) {
  RIGCAL_TRY(CheckScalar(file, element));
  const std::size_t bytes = BytesOf(element);
  if (bytes == 0) return {};
  const auto cut = [&] {
    return RefuseCloud(file, "ends within the " + std::to_string(element.count) + " of element " + Quoted(element.name),
                       "The file is cut off or its header is wrong: copy or save it again.");
  };
  if (!is_text) {
    if (element.count > rest.body.size() / bytes) return cut();
    rest.body.remove_prefix(element.count * bytes);
    return {};
  }
  TextLines lines(rest.body, rest.line);
  for (std::uint64_t i = 0; i < element.count; ++i)
    if (!lines.NextFilled()) return cut();
  rest = {lines.rest(), lines.line() + 1};
  return {};
}

Result<CloudTable> TableOf(const std::string& file, const Element& vertex) {
  RIGCAL_TRY(CheckScalar(file, vertex));
  CloudTable table{file, vertex.count, vertex.properties.size(), BytesOf(vertex), {}};
  if (table.words_per_line > limits::kCloudFieldsMax)
    return RefuseCloud(file, "a point has more than " + std::to_string(limits::kCloudFieldsMax) + " values",
                       "Leave fields out that no calibration needs.");
  std::size_t start_bytes = 0;
  for (const Property& property : vertex.properties) {
    table.columns.push_back({property.name, property.type, start_bytes, table.point_bytes, table.columns.size()});
    start_bytes += SizeOf(property.type);
  }
  RIGCAL_TRY(CheckTable(table));
  return table;
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> PlySize(std::string_view bytes) {
  const std::string unnamed;
  const auto header = HeaderReader(unnamed).Read(bytes);
  if (!header) return std::nullopt;
  for (const Element& element : header->elements)
    if (element.name == "vertex") return std::pair(element.count, element.properties.size());
  return std::nullopt;
}

Result<Cloud> ReadPly(std::string_view bytes, const std::string& name) {
  RIGCAL_ASSIGN(const PlyHeader header, HeaderReader(name).Read(bytes));
  Rest rest{bytes.substr(header.body_offset_bytes), header.body_line};
  std::size_t e = 0;
  for (; e < header.elements.size() && header.elements[e].name != "vertex"; ++e)
    RIGCAL_TRY(Skip(name, header.elements[e], *header.body == PlyBody::kAscii, rest));
  if (e == header.elements.size())
    return RefuseCloud(name, "has no element \"vertex\"", "Save the cloud's points as PLY vertices.");
  RIGCAL_ASSIGN(const CloudTable table, TableOf(name, header.elements[e]));
  const bool is_last = e + 1 == header.elements.size();
  if (*header.body == PlyBody::kAscii) return CloudOfText(table, rest.body, rest.line, is_last);
  RIGCAL_TRY(CheckBinarySize(table, rest.body, is_last));
  const ByteOrder order = *header.body == PlyBody::kBig ? ByteOrder::kBig : ByteOrder::kLittle;
  return CloudOfBinary(table, std::as_bytes(std::span(rest.body)), order);
}

}  // namespace rigcal::formats
