#include "server/formats/clouds/pcd_header.h"

#include <array>
#include <map>
#include <optional>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/clouds/cloud_text.h"

namespace rigcal::formats {
namespace {

using Words = std::vector<std::string_view>;

constexpr const char* kPcdCure = "Mend the header, or save the cloud again as PCD 0.7.";
constexpr std::array<std::string_view, 6> kVersions = {"0.7", ".7", "0.6", ".6", "0.5", ".5"};
constexpr std::array<std::string_view, 10> kKeys = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                                    "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

template <typename Range>
bool Contains(const Range& range, std::string_view word) {
  for (const std::string_view known : range)
    if (known == word) return true;
  return false;
}

std::optional<Scalar> ScalarOf(std::string_view type, std::string_view size) {
  static const std::map<std::string, Scalar, std::less<>> kTypes = {
      {"I1", Scalar::kInt8},    {"I2", Scalar::kInt16},  {"I4", Scalar::kInt32},  {"I8", Scalar::kInt64},
      {"U1", Scalar::kUint8},   {"U2", Scalar::kUint16}, {"U4", Scalar::kUint32}, {"U8", Scalar::kUint64},
      {"F4", Scalar::kFloat32}, {"F8", Scalar::kFloat64}};
  if (type.size() != 1 || size.size() != 1) return std::nullopt;
  const auto found = kTypes.find(std::string(type) + std::string(size));
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

class PcdReader {
 public:
  explicit PcdReader(const std::string& name) : name_(name) {}

  Result<PcdHeader> Read(std::string_view bytes) {
    TextLines lines(bytes.substr(0, limits::kCloudHeaderBytesMax));
    while (values_.count("DATA") == 0) {
      const auto line = lines.NextFilled();
      if (!line)
        return Refuse("its header has no DATA line in its first " + std::to_string(TextBytes(bytes)) + " bytes");
      RIGCAL_TRY(TakeLine(*line, lines.line()));
    }
    header_.body_offset_bytes = TextBytes(bytes) - lines.rest().size();
    header_.body_line = lines.line() + 1;
    RIGCAL_TRY(CheckVersion());
    RIGCAL_TRY(SetFields());
    RIGCAL_TRY(SetPoints());
    RIGCAL_TRY(SetBody());
    return std::move(header_);
  }

 private:
  static std::size_t TextBytes(std::string_view bytes) { return std::min(bytes.size(), limits::kCloudHeaderBytesMax); }
  [[nodiscard]] tl::unexpected<Error> Refuse(const std::string& what) const {
    return RefuseCloud(name_, what, kPcdCure);
  }

  Status TakeLine(std::string_view line, std::size_t number) {
    const std::string at = "line " + std::to_string(number) + ": ";
    const std::string_view key = TakeWord(line);
    if (key.front() == '#') return {};
    if (!Contains(kKeys, key)) return Refuse(at + Quoted(key) + " is no key of a PCD header");
    if (!values_.emplace(key, WordsOf(line)).second) return Refuse(at + std::string(key) + " occurs twice");
    return {};
  }

  [[nodiscard]] Status CheckVersion() const {
    const auto version = values_.find("VERSION");
    if (version == values_.end()) return {};
    if (version->second.size() == 1 && Contains(kVersions, version->second[0])) return {};
    const std::string_view text = version->second.empty() ? "" : version->second[0];
    return Refuse("VERSION " + Quoted(text) + " is none of 0.5, 0.6 and 0.7");
  }

  // One word for each field.
  Result<Words> WordsPerField(std::string_view key) const {
    const auto found = values_.find(key);
    if (found == values_.end()) return Refuse("its header has no " + std::string(key) + " line");
    const std::size_t fields = values_.find("FIELDS")->second.size();
    if (found->second.size() != fields)
      return Refuse(std::string(key) + " has " + std::to_string(found->second.size()) + " entries for " +
                    std::to_string(fields) + " fields");
    return found->second;
  }

  Status SetFields() {
    const auto names = values_.find("FIELDS");
    if (names == values_.end()) return Refuse("its header has no FIELDS line");
    RIGCAL_ASSIGN(const Words sizes, WordsPerField("SIZE"));
    RIGCAL_ASSIGN(const Words types, WordsPerField("TYPE"));
    Words counts(sizes.size(), "1");
    if (values_.count("COUNT") > 0)
      RIGCAL_TRY(WordsPerField("COUNT").map([&](Words words) { counts = std::move(words); }));
    for (std::size_t f = 0; f < sizes.size(); ++f)
      RIGCAL_TRY(AddField(names->second[f], types[f], sizes[f], counts[f]));
    return {};
  }

  Status AddField(std::string_view name, std::string_view type, std::string_view size, std::string_view count) {
    const auto scalar = ScalarOf(type, size);
    if (!scalar)
      return Refuse("field " + Quoted(name) + " has TYPE " + Quoted(type) + " and SIZE " + Quoted(size) +
                    "; there are I and U of 1, 2, 4, 8 bytes and F of 4, 8");
    const auto values = CountOf(count);
    if (!values || *values == 0 || *values > kPcdCountMax)
      return Refuse("field " + Quoted(name) + " has COUNT " + Quoted(count) + ", not 1 to " +
                    std::to_string(kPcdCountMax));
    header_.fields.push_back({std::string(name), *scalar, *values});
    return {};
  }

  // The one number of a line; nothing if the line is absent.
  Result<std::optional<std::uint64_t>> Number(std::string_view key) const {
    const auto found = values_.find(key);
    if (found == values_.end()) return std::nullopt;
    const std::string_view word = found->second.empty() ? "" : found->second[0];
    const auto number = CountOf(word);
    if (!number || found->second.size() != 1) return Refuse(std::string(key) + " " + Quoted(word) + " is not a count");
    return number;
  }

  Status SetPoints() {
    RIGCAL_ASSIGN(const auto width, Number("WIDTH"));
    RIGCAL_ASSIGN(const auto height, Number("HEIGHT"));
    RIGCAL_ASSIGN(const auto points, Number("POINTS"));
    if (!width && !points) return Refuse("its header has neither WIDTH nor POINTS");
    std::uint64_t product = 0;
    if (width && __builtin_mul_overflow(*width, height.value_or(1), &product))
      return Refuse("WIDTH " + std::to_string(*width) + " times HEIGHT " + std::to_string(*height) + " is no count");
    if (width && points && *points != product)
      return Refuse("POINTS " + std::to_string(*points) + " is not WIDTH times HEIGHT, " + std::to_string(product));
    header_.points = points ? *points : product;
    return {};
  }

  Status SetBody() {
    const Words& words = values_.find("DATA")->second;
    const std::string_view kind = words.size() == 1 ? words[0] : "";
    if (kind == "ascii") {
      header_.body = PcdBody::kAscii;
    } else if (kind == "binary") {
      header_.body = PcdBody::kBinary;
    } else if (kind == "binary_compressed") {
      header_.body = PcdBody::kBinaryCompressed;
    } else {
      return Refuse("DATA " + Quoted(kind) + " is none of ascii, binary and binary_compressed");
    }
    return {};
  }

  const std::string& name_;
  std::map<std::string_view, Words> values_;
  PcdHeader header_;
};

}  // namespace

Result<PcdHeader> ReadPcdHeader(std::string_view bytes, const std::string& name) { return PcdReader(name).Read(bytes); }

}  // namespace rigcal::formats
