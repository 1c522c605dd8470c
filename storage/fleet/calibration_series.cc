#include "storage/fleet/calibration_series.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kPerSigma = 1000.0, kSigmasMax = 1e12;  // beyond, all are alike
// A policy or a new computation makes revisions of the same measurements.
constexpr std::size_t kRevisionsLookedAtMax = 4 * kCalibrationsListedMax;

std::string TextOfPoint(const CalibrationPoint& point) {
  const std::string at = std::to_string(point.calibrated_at.ns / kSecond_ns) + " ";
  if (!point.worst_sigmas) return at + "-";
  return at + std::to_string(std::llround(std::clamp(*point.worst_sigmas, 0.0, kSigmasMax) * kPerSigma));
}

// Moves past the number.
std::optional<std::int64_t> TakeNumber(std::string_view& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

std::optional<CalibrationPoint> PointOf(std::string_view text) {
  const std::optional<std::int64_t> at_s = TakeNumber(text);
  if (!at_s || text.empty() || text.front() != ' ') return std::nullopt;
  text.remove_prefix(1);
  if (text == "-") return CalibrationPoint{Stamp{*at_s * kSecond_ns}};
  const std::optional<std::int64_t> thousandths = TakeNumber(text);
  if (!thousandths || !text.empty()) return std::nullopt;
  return CalibrationPoint{Stamp{*at_s * kSecond_ns}, static_cast<double>(*thousandths) / kPerSigma};
}

}  // namespace

Result<std::vector<CalibrationPoint>> LoadCalibrations(Store& store, const RobotId& robot) {
  using Points = std::vector<CalibrationPoint>;
  return Load<Points>(store, "calibrations of robot " + robot.str(), [&]() -> Result<Points> {
    Query query(store,
                "SELECT c.calibrated_ns, w.residual_ratio FROM revision_calibrated c LEFT JOIN revision_worst_edge w "
                "ON w.robot_id = c.robot_id AND w.revision_number = c.revision_number "
                "WHERE c.robot_id = ? ORDER BY c.revision_number DESC LIMIT ?");
    query.Bind(robot, kRevisionsLookedAtMax);
    Points newest_first;
    while (query.Step())
      newest_first.push_back({query.Time(0), query.IsNull(1) ? std::nullopt : std::optional(query.Real(1))});
    return CalibrationsOf(newest_first);
  });
}

std::string TextOfCalibrations(const std::vector<CalibrationPoint>& points) {
  std::string text;
  for (const CalibrationPoint& point : points) text += (text.empty() ? "" : ",") + TextOfPoint(point);
  return text;
}

std::vector<CalibrationPoint> CalibrationsOfText(const std::string& text) {
  std::vector<CalibrationPoint> points;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const auto point = PointOf(rest.substr(0, comma));
    if (!point) break;
    points.push_back(*point);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  return points;
}

}  // namespace rigcal::storage
