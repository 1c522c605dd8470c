#include "server/formats/clouds/cloud_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/formats/clouds/cloud_text.h"

namespace rigcal::formats {
namespace {

constexpr double kCoordinateMax_m = 1e3;
constexpr const char* kCutCure = "The file is cut off or its header is wrong: copy or record it again.";
constexpr const char* kMoreCure = "The header's number of points is wrong: save the cloud again.";

template <typename T>
double Load(const std::byte* from, ByteOrder order) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (order == ByteOrder::kBig) std::reverse(bytes.begin(), bytes.end());
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return static_cast<double>(value);
}

double LoadScalar(const std::byte* from, Scalar type, ByteOrder order) {
  switch (type) {
    case Scalar::kInt8:
      return Load<std::int8_t>(from, order);
    case Scalar::kInt16:
      return Load<std::int16_t>(from, order);
    case Scalar::kInt32:
      return Load<std::int32_t>(from, order);
    case Scalar::kInt64:
      return Load<std::int64_t>(from, order);
    case Scalar::kUint8:
      return Load<std::uint8_t>(from, order);
    case Scalar::kUint16:
      return Load<std::uint16_t>(from, order);
    case Scalar::kUint32:
      return Load<std::uint32_t>(from, order);
    case Scalar::kUint64:
      return Load<std::uint64_t>(from, order);
    case Scalar::kFloat32:
      return Load<float>(from, order);
    case Scalar::kFloat64:
      break;
  }
  return Load<double>(from, order);
}

// Axis of a column: 0 1 2 of "x" "y" "z", else -1.
int AxisOf(const std::string& name) {
  return name.size() == 1 && name[0] >= 'x' && name[0] <= 'z' ? name[0] - 'x' : -1;
}

bool IsCoordinate(double value) { return std::abs(value) <= kCoordinateMax_m; }

// Collects rows of a table that passed CheckTable.
class Collector {
 public:
  explicit Collector(const CloudTable& table) : table_(table), usable_(table.columns.size(), true) {
    cloud_.points_m.reserve(table.points);
    fields_.resize(table.columns.size());
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const int axis = AxisOf(table.columns[c].name);
      if (axis >= 0) xyz_[static_cast<std::size_t>(axis)] = c, usable_[c] = false;
      if (axis < 0) fields_[c].reserve(table.points);
    }
  }

  // One value per column.
  void Add(const std::vector<double>& row) {
    const double x = row[xyz_[0]], y = row[xyz_[1]], z = row[xyz_[2]];
    if (!IsCoordinate(x) || !IsCoordinate(y) || !IsCoordinate(z)) {
      ++cloud_.dropped;
      cloud_.beyond_1km += std::isfinite(x) && std::isfinite(y) && std::isfinite(z) ? 1 : 0;
      return;
    }
    cloud_.points_m.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    for (std::size_t c = 0; c < row.size(); ++c)
      if (usable_[c]) AddValue(c, row[c]);
  }

  Result<Cloud> Finish() {
    if (cloud_.points_m.empty() && cloud_.beyond_1km > 0)
      return RefuseCloud(table_.file,
                         "of its points " + std::to_string(cloud_.beyond_1km) +
                             " lie beyond 1 km, and none within: the unit is not metres, or the layout another",
                         "Save the cloud in metres; of a .bin, check fields and point_type in session.yaml.");
    if (cloud_.points_m.empty())
      return RefuseCloud(table_.file, "holds no point with finite coordinates",
                         "Record the capture again with something in the lidar's view.");
    for (std::size_t c = 0; c < fields_.size(); ++c) {
      const std::string& name = table_.columns[c].name;
      if (usable_[c]) cloud_.fields.push_back({name, std::move(fields_[c])});
      if (!usable_[c] && AxisOf(name) < 0) cloud_.left_out.push_back(name);
    }
    return std::move(cloud_);
  }

 private:
  void AddValue(std::size_t column, double value) {
    if (std::isfinite(value)) return fields_[column].push_back(value);
    usable_[column] = false;
    fields_[column] = {};
  }

  const CloudTable& table_;
  Cloud cloud_;
  std::array<std::size_t, 3> xyz_{};
  std::vector<bool> usable_;  // per column: a field, so far without a value that is not finite
  std::vector<std::vector<double>> fields_;
};

std::string At(std::size_t line) { return "line " + std::to_string(line) + ": "; }

// The words of a point's line.
Status ReadRow(const CloudTable& table, std::string_view text, std::size_t line, std::vector<double>& words) {
  for (std::size_t w = 0; w < words.size(); ++w) {
    const std::string_view word = TakeWord(text);
    if (word.empty())
      return RefuseCloud(table.file,
                         At(line) + "has " + std::to_string(w) + " of " + std::to_string(words.size()) + " numbers",
                         kCutCure);
    const std::optional<double> number = NumberOf(word);
    if (!number) return RefuseCloud(table.file, At(line) + Quoted(word) + " is not a number", "Correct this line.");
    words[w] = *number;
  }
  if (const std::string_view extra = TakeWord(text); !extra.empty())
    return RefuseCloud(table.file, At(line) + "has more than " + std::to_string(words.size()) + " numbers",
                       "Write one point per line, or correct the header.");
  return {};
}

// Each word takes a character and what parts it from the next.
Status CheckTextSize(const CloudTable& table, std::size_t body_bytes) {
  if (table.points <= (body_bytes + 1) / (2 * table.words_per_line)) return {};
  return RefuseCloud(table.file,
                     "its header announces " + std::to_string(table.points) + " points, but the " +
                         std::to_string(body_bytes) + " bytes after it cannot hold them",
                     kCutCure);
}

Status CheckNames(const CloudTable& table) {
  std::set<std::string_view> names;
  for (const CloudColumn& column : table.columns) {
    if (column.name.size() > limits::kNameMax || !IsPrintableUtf8(column.name))
      return RefuseCloud(table.file, "the name of field " + Quoted(column.name) + " is too long or not printable",
                         "Name fields in at most " + std::to_string(limits::kNameMax) + " characters of UTF-8.");
    if (!names.insert(column.name).second)
      return RefuseCloud(table.file, "field " + Quoted(column.name) + " occurs twice", "Give each field its own name.");
    const bool is_float = column.type == Scalar::kFloat32 || column.type == Scalar::kFloat64;
    if (AxisOf(column.name) >= 0 && !is_float)
      return RefuseCloud(table.file, "field " + Quoted(column.name) + " is an integer",
                         "Save coordinates as float or double, in metres.");
  }
  for (const char* axis : {"x", "y", "z"})
    if (names.count(axis) == 0)
      return RefuseCloud(table.file, "field " + Quoted(axis) + " is missing",
                         "Save the cloud with its fields x, y and z.");
  return {};
}

}  // namespace

std::size_t SizeOf(Scalar type) {
  switch (type) {
    case Scalar::kInt8:
    case Scalar::kUint8:
      return 1;
    case Scalar::kInt16:
    case Scalar::kUint16:
      return 2;
    case Scalar::kInt32:
    case Scalar::kUint32:
    case Scalar::kFloat32:
      return 4;
    case Scalar::kInt64:
    case Scalar::kUint64:
    case Scalar::kFloat64:
      break;
  }
  return 8;
}

tl::unexpected<Error> RefuseCloud(const std::string& file, const std::string& what, std::string cure) {
  return Fail(ErrorCode::kInvalidInput, "file " + Quoted(file) + ": " + what, std::move(cure));
}

Status CheckTable(const CloudTable& table) {
  if (table.points > limits::kCloudPointsMax)
    return RefuseCloud(table.file, "its header announces " + std::to_string(table.points) + " points",
                       "A cloud has at most " + std::to_string(limits::kCloudPointsMax) + " points: thin it out.");
  if (table.columns.size() > limits::kCloudFieldsMax)
    return RefuseCloud(table.file, "a point has more than " + std::to_string(limits::kCloudFieldsMax) + " values",
                       "Leave fields out that no calibration needs.");
  if (table.points * table.columns.size() > limits::kCloudValuesMax)
    return RefuseCloud(table.file,
                       "its header announces " + std::to_string(table.points * table.columns.size()) + " values",
                       "A cloud has at most " + std::to_string(limits::kCloudValuesMax) + " values: leave fields out.");
  return CheckNames(table);
}

Status CheckBinarySize(const CloudTable& table, std::string_view body, bool is_last) {
  const std::string there = "its header announces " + std::to_string(table.points) + " points of " +
                            std::to_string(table.point_bytes) + " bytes, but " + std::to_string(body.size()) +
                            " bytes follow it";
  if (table.points > body.size() / table.point_bytes) return RefuseCloud(table.file, there, kCutCure);
  const std::string_view rest = body.substr(table.points * table.point_bytes);
  const bool is_more = rest.size() >= table.point_bytes && rest.find_first_not_of('\0') != std::string_view::npos;
  if (is_last && is_more) return RefuseCloud(table.file, there, kMoreCure);
  return {};
}

Result<Cloud> CloudOfBinary(const CloudTable& table, std::span<const std::byte> body, ByteOrder order) {
  Collector collector(table);
  std::vector<double> row(table.columns.size());
  for (std::size_t i = 0; i < table.points; ++i) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const CloudColumn& column = table.columns[c];
      row[c] = LoadScalar(body.data() + column.start_bytes + i * column.step_bytes, column.type, order);
    }
    collector.Add(row);
  }
  return collector.Finish();
}

Result<Cloud> CloudOfText(const CloudTable& table, std::string_view body, std::size_t line, bool is_last) {
  RIGCAL_TRY(CheckTextSize(table, body.size()));
  Collector collector(table);
  TextLines lines(body, line);
  std::vector<double> words(table.words_per_line), row(table.columns.size());
  for (std::size_t i = 0; i < table.points; ++i) {
    const auto text = lines.NextFilled();
    if (!text)
      return RefuseCloud(
          table.file, "ends after " + std::to_string(i) + " of " + std::to_string(table.points) + " points", kCutCure);
    RIGCAL_TRY(ReadRow(table, *text, lines.line(), words));
    for (std::size_t c = 0; c < row.size(); ++c) row[c] = words[table.columns[c].word_idx];
    collector.Add(row);
  }
  if (is_last && lines.NextFilled())
    return RefuseCloud(table.file,
                       At(lines.line()) + "follows the last of the " + std::to_string(table.points) + " points",
                       kMoreCure);
  return collector.Finish();
}

}  // namespace rigcal::formats
