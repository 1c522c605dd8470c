#include "server/formats/sessions/poses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "server/base/limits.h"
#include "server/base/number_text.h"
#include "server/base/text.h"
#include "server/formats/clouds/cloud_text.h"
#include "server/model/plausible.h"

namespace rigcal::formats {
namespace {

constexpr std::string_view kTrackerHeader = "capture,stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw";
constexpr std::string_view kStreamHeader = "stamp_ns,x_m,y_m,z_m,qx,qy,qz,qw";
constexpr const char* kPosesCure = "Mend the line; docs/session-format.md describes poses.csv.";
constexpr double kPosesUnitTolerance = 1e-3;                      // of quaternions with few digits
constexpr std::int64_t kStampMax_ns = 4'000'000'000'000'000'000;  // differences of two clocks stay in range
constexpr std::size_t kNumbers = 7;

// Where an error is: file and line.
struct Place {
  const std::string& name;
  std::size_t line;

  [[nodiscard]] tl::unexpected<Error> Refuse(const std::string& what, const std::string& cure = kPosesCure) const {
    return Fail(ErrorCode::kInvalidInput, name + " line " + std::to_string(line) + ": " + what, cure);
  }
};

// The next field of a row, which is shortened by it and its comma; nothing behind the last one.
std::optional<std::string_view> TakeField(std::optional<std::string_view>& row) {
  if (!row) return std::nullopt;
  const std::size_t comma = row->find(',');
  const std::string_view field = row->substr(0, comma);
  row = comma == std::string_view::npos ? std::nullopt : std::optional(row->substr(comma + 1));
  return field;
}

std::string ColumnOf(SensorKind kind, std::size_t idx) {
  std::optional<std::string_view> header = PoseHeader(kind);
  for (std::size_t i = 0; i < idx; ++i) TakeField(header);
  return std::string(*TakeField(header));
}

std::size_t ColumnCount(SensorKind kind) {
  const std::string_view header = PoseHeader(kind);
  return static_cast<std::size_t>(std::count(header.begin(), header.end(), ',')) + 1;
}

Result<Stamp> ReadStamp(std::string_view field, const Place& place) {
  const auto stamp_ns = NumberIn<std::int64_t>(field);
  if (stamp_ns && *stamp_ns >= 0 && *stamp_ns <= kStampMax_ns) return Stamp{*stamp_ns};
  return place.Refuse("stamp_ns " + Quoted(field) + " is not a whole number from 0 to 4e18",
                      "Give the time in nanoseconds.");
}

Result<Se3> PoseOf(const std::array<double, kNumbers>& values, const Place& place) {
  Se3 T;
  T.p_m = {values[0], values[1], values[2]};
  T.q = Eigen::Quaterniond(values[6], values[3], values[4], values[5]);
  if (!(std::abs(T.q.norm() - 1) <= kPosesUnitTolerance))
    return place.Refuse("the quaternion has the length " + std::to_string(T.q.norm()) + ", not 1",
                        "Give qx,qy,qz,qw of a unit quaternion, the scalar last.");
  if (const Status near = CheckPlausible(T.p_m); !near) return place.Refuse(near.error().what, near.error().cure);
  return T.Normalized();
}

Result<std::array<double, kNumbers>> ReadNumbers(std::optional<std::string_view>& row, SensorKind kind,
                                                 const Place& place) {
  std::array<double, kNumbers> values{};
  const std::size_t first = ColumnCount(kind) - kNumbers;
  for (std::size_t i = 0; i < kNumbers; ++i) {
    const std::string_view field = *TakeField(row);
    const std::optional<double> value = NumberOf(field);
    if (!value || !std::isfinite(*value))
      return place.Refuse(ColumnOf(kind, first + i) + " " + Quoted(field) + " is not a finite number");
    values[i] = *value;
  }
  return values;
}

Result<TimedPose> ReadRow(std::string_view line, SensorKind kind, const Place& place) {
  const auto commas = static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
  if (commas + 1 != ColumnCount(kind))
    return place.Refuse("it has " + std::to_string(commas + 1) + " fields, not the " +
                        std::to_string(ColumnCount(kind)) + " of " + std::string(PoseHeader(kind)));
  std::optional<std::string_view> row = line;
  TimedPose pose;
  const std::string_view name = kind == SensorKind::kTracker ? *TakeField(row) : "";
  if (!name.empty()) {
    auto capture = CaptureId::Parse(name);
    if (!capture) return place.Refuse(capture.error().what, capture.error().cure);
    pose.capture = *std::move(capture);
  }
  RIGCAL_ASSIGN(pose.stamp, ReadStamp(*TakeField(row), place));
  RIGCAL_ASSIGN(const auto values, ReadNumbers(row, kind, place));
  RIGCAL_ASSIGN(pose.T_world_body, PoseOf(values, place));
  return pose;
}

// What a row says about those before it.
class Order {
 public:
  Status Check(const TimedPose& pose, const Place& place) {
    if (!pose.capture.empty()) {
      if (captures_.insert(pose.capture).second) return {};
      return place.Refuse("capture " + pose.capture.str() + " has a row already", "Keep one row per capture.");
    }
    if (last_ && pose.stamp.ns <= last_->ns)
      return place.Refuse("stamp_ns " + std::to_string(pose.stamp.ns) + " is not after that of the row before, " +
                              std::to_string(last_->ns),
                          "Sort the rows by time and keep one per stamp.");
    last_ = pose.stamp;
    return {};
  }

 private:
  std::set<CaptureId> captures_;
  std::optional<Stamp> last_;  // of the rows without a capture
};

Status CheckHeader(TextLines& lines, SensorKind kind, const std::string& name) {
  const std::optional<std::string_view> header = lines.NextFilled();
  const Place place{name, header ? lines.line() : 1};
  if (header && *header == PoseHeader(kind)) return {};
  return place.Refuse(
      "the header is " + Quoted(header.value_or("")) + ", not " + std::string(PoseHeader(kind)),
      "Begin the file with exactly this line; a tracker's has a capture in front, a pose stream's not.");
}

// Of a tracker its path apart; of a pose stream all rows are poses.
struct Tables {
  PoseTable poses, path;
};

Result<Tables> Read(const std::set<CaptureId>* captures, std::string_view text, SensorKind kind,
                    const std::string& name) {
  if (text.size() > limits::kPoseTableBytesMax)
    return Fail(ErrorCode::kInvalidInput,
                name + ": it is larger than " + std::to_string(limits::kPoseTableBytesMax) + " bytes",
                "Record fewer poses per second, or a shorter time.");
  TextLines lines(text);
  RIGCAL_TRY(CheckHeader(lines, kind, name));
  Tables tables;
  Order order;
  while (const auto line = lines.NextFilled()) {
    const Place place{name, lines.line()};
    if (tables.poses.size() + tables.path.size() == limits::kPoseTableRowsMax)
      return place.Refuse("it has more than " + std::to_string(limits::kPoseTableRowsMax) + " rows",
                          "Record fewer poses per second, or a shorter time.");
    RIGCAL_ASSIGN(TimedPose pose, ReadRow(*line, kind, place));
    RIGCAL_TRY(order.Check(pose, place));
    if (captures && !pose.capture.empty() && !captures->contains(pose.capture))
      return place.Refuse("no other sensor has a capture " + pose.capture.str(),
                          "Name the row after the files of its instant, or remove it.");
    const bool is_of_path = kind == SensorKind::kTracker && pose.capture.empty();
    (is_of_path ? tables.path : tables.poses).push_back(std::move(pose));
  }
  if (tables.poses.empty()) return Fail(ErrorCode::kInvalidInput, name + ": it has no poses", "Add a row per pose.");
  if (kind == SensorKind::kTracker)
    std::sort(tables.poses.begin(), tables.poses.end(),
              [](const TimedPose& x, const TimedPose& y) { return x.capture < y.capture; });
  return tables;
}

Result<PoseTable> PosesIn(Result<Tables> tables) {
  if (!tables) return Fail(tables.error());
  return std::move(tables->poses);
}

}  // namespace

std::string_view PoseHeader(SensorKind kind) {
  return kind == SensorKind::kPoseStream ? kStreamHeader : kTrackerHeader;
}

Result<PoseTable> ReadPoses(std::string_view text, SensorKind kind, const std::string& name) {
  return PosesIn(Read(nullptr, text, kind, name));
}

Result<PoseTable> ReadPosesOf(const std::set<CaptureId>& captures, std::string_view text, const std::string& name) {
  return PosesIn(Read(&captures, text, SensorKind::kTracker, name));
}

Result<PoseTable> ReadTrackerPath(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(Tables tables, Read(nullptr, text, SensorKind::kTracker, name));
  return std::move(tables.path);
}

}  // namespace rigcal::formats
