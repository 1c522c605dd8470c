#include "server/fleet/status/sensor_status.h"

#include <algorithm>
#include <set>

#include "server/fleet/as_found/as_found.h"
#include "server/fleet/findings/not_needed.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

constexpr double kStatusDay_ns = 86'400e9;
// With fewer in use, and none of other robots, the scatter between visits is the policy's word (WithScatter of
// as_found.cc). A sigma that nobody measured, taken out of changes as their noise, hides a drift that is as large.
constexpr int kVisitsThatTellScatter = 2;

const SensorFound* FoundOfSensor(const std::optional<AsFound>& found, const SensorId& sensor) {
  if (!found || !found->why_not.empty()) return nullptr;
  const auto one = std::find_if(found->sensors.begin(), found->sensors.end(),
                                [&](const SensorFound& other) { return other.sensor == sensor; });
  return one == found->sensors.end() ? nullptr : &*one;
}

// "revision 2, captured 3 Nov 2026"
std::string SinceWhat(const StatusInput& input) {
  const std::string revision = "revision " + std::to_string(input.found->in_use);
  return input.in_use_captured_at ? revision + ", captured " + DayText(*input.in_use_captured_at) : revision;
}

// What was done in that time was done by a pose that was no longer true.
std::string MayBeAffected(const StatusInput& input) {
  const std::optional<Stamp>& since = input.in_use_captured_at;
  const std::string until = DayText(input.found->captured_at);
  if (!since || input.found->captured_at < *since) return "what was done before " + until + " may be affected";
  return "what was done from " + DayText(*since) + " to " + until + " may be affected";
}

std::string WhoMoved(const SensorFound& sensor) {
  return sensor.or_else.empty() ? sensor.sensor.str() : sensor.sensor.str() + " or " + sensor.or_else.str();
}

std::string CheckMount(const SensorFound& sensor) {
  return sensor.or_else.empty() ? "Check its mount" : "Check the mounts of both";
}

CalibrationStatus DriftedStatus(const SensorFound& sensor, const StatusInput& input, const PoseLimit& tolerance) {
  const std::string moved = WhoMoved(sensor) + " moved by " + OffList(sensor.change) + " (" +
                            Number(InSigmas(sensor), "sigma") + ") since " + SinceWhat(input);
  if (!IsBeyond(sensor.change, tolerance))
    return {StatusWord::kDrifted, moved + "; the calibration was updated.",
            CheckMount(sensor) + "; if it was moved on purpose, name it as remounted in the next session."};
  return {StatusWord::kOutOfTolerance,
          moved + ", beyond the tolerance of " + LimitText(tolerance) + ": " + MayBeAffected(input) + ".",
          CheckMount(sensor) + ", and what was done in that time."};
}

// What it drifts by until a calibration is overdue is more than the least move.
PoseLimit LeastPer30Days(const StatusInput& input, const SensorId& sensor) {
  const PoseLimit least = LimitsOf(input.policy, sensor).moved_min;
  const double share = 30 * kStatusDay_ns / static_cast<double>(std::max<std::int64_t>(1, input.max_age_ns));
  return {share * least.m, share * least.rad};
}

CalibrationStatus DriftingStatus(const SensorFound* sensor, const StatusInput& input) {
  if (sensor == nullptr) return {};
  const auto drifting = DriftingOf(*sensor, *input.found, LeastPer30Days(input, sensor->sensor));
  if (!drifting) return {};
  return {StatusWord::kDrifted, DriftingText(*sensor, *drifting) + ".",
          "Check its mount; until it holds, calibrate more often than the drift reaches the tolerance."};
}

bool HasTwoPoses(const GraphSolution& solution, const SensorId& sensor) {
  const auto& two = solution.suspects.two_poses;
  return std::any_of(two.begin(), two.end(), [&](const TwoPoses& one) { return one.sensor == sensor; });
}

CalibrationStatus UncertainStatus(const SensorPose& pose, const PoseLimit& tolerance,
                                  const std::optional<Stamp>& calibrated_at) {
  const Vector6d sigma = pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const double sigma_m = sigma.head<3>().maxCoeff(), sigma_rad = sigma.tail<3>().maxCoeff();
  if (sigma_m <= tolerance.m && sigma_rad <= tolerance.rad) return {};
  const std::string since = calibrated_at ? " since " + DayText(*calibrated_at) : "";
  return {StatusWord::kOutOfTolerance,
          "The pose of " + pose.sensor.str() + " is known to " + SigmaText(sigma_m, sigma_rad) +
              " only, more than the tolerance of " + LimitText(tolerance) + ": what was done by it" + since +
              " may be affected.",
          "Capture it again at more distances and tilts."};
}

bool Has(const std::vector<SensorId>& sensors, const SensorId& sensor) {
  return std::find(sensors.begin(), sensors.end(), sensor) != sensors.end();
}

// What an unknown verdict does not rely on: those that it names, or all where it names none.
bool IsDoubted(const SensorPose& pose, const StatusInput& input) {
  if (!input.judged || input.judged->level != VerdictLevel::kUnknown) return false;
  const std::vector<SensorId>& doubted = input.judged->basis.doubted;
  return doubted.empty() || Has(doubted, pose.sensor);
}

bool IsAccused(const SensorPose& pose, const StatusInput& input) {
  return input.judged && input.judged->level == VerdictLevel::kFail && Has(input.judged->basis.culprits, pose.sensor);
}

// A verdict that does not fail took what its edges say for chance, too small to matter, or for pairs that whole
// sessions stand above.
bool IsOfTwoPoses(const SensorPose& pose, const StatusInput& input) {
  return HasTwoPoses(input.solution, pose.sensor) && (!input.judged || input.judged->level == VerdictLevel::kFail);
}

CalibrationStatus StatusOfSensor(const SensorPose& pose, const StatusInput& input) {
  const PoseLimit tolerance = LimitsOf(input.policy, pose.sensor).tolerance;
  const SensorFound* found = FoundOfSensor(input.found, pose.sensor);
  if (found != nullptr && found->state == FoundState::kDrifted) return DriftedStatus(*found, input, tolerance);
  if (IsOfTwoPoses(pose, input))
    return {StatusWord::kFailed, "Its edges give " + pose.sensor.str() + " two poses.", "Do what the verdict says."};
  if (IsAccused(pose, input))
    return {StatusWord::kFailed, "The verdict accuses " + pose.sensor.str() + ".", "Do what the verdict says."};
  if (!pose.known && pose.measured_part)
    return {StatusWord::kUnknown, "The pose of " + pose.sensor.str() + " was measured in part only.",
            "Do what the verdict says."};
  if (!pose.known)
    return {StatusWord::kUnknown, "The pose of " + pose.sensor.str() + " is not known.", "Do what the verdict says."};
  if (pose.sensor != input.reference)
    if (const auto uncertain = UncertainStatus(pose, tolerance, input.calibrated_at); uncertain.word != StatusWord::kOk)
      return uncertain;
  if (IsDoubted(pose, input))
    return {StatusWord::kUnknown, "The pose of " + pose.sensor.str() + " is not verified.",
            "Do what the verdict says."};
  return DriftingStatus(found, input);
}

std::optional<DriftDue> DueOfSensor(const SensorId& sensor, const StatusInput& input) {
  const auto steps = input.steps.find(sensor);
  if (steps == input.steps.end() || !input.calibrated_at) return std::nullopt;
  const PoseLimit tolerance = LimitsOf(input.policy, sensor).tolerance;
  const auto forecast =
      ForecastDrift(steps->second, input.robot, tolerance, static_cast<double>(input.max_age_ns) / kStatusDay_ns);
  if (!forecast) return std::nullopt;
  const Stamp at{input.calibrated_at->ns + static_cast<std::int64_t>(forecast->days * kStatusDay_ns)};
  return DriftDue{sensor, at, forecast->law, forecast->visits, forecast->robots};
}

}  // namespace

void AddSteps(const RobotId& robot, const AsFound& found, double days, DriftSteps& steps) {
  if (!found.why_not.empty() || (found.visits < kVisitsThatTellScatter && found.scatter_robots == 0)) return;
  for (const SensorFound& sensor : found.sensors)
    if (IsTested(sensor)) steps[sensor.sensor].push_back({robot, days, sensor.change, sensor.sigma});
}

StatusFacts JudgeStatus(const StatusInput& input) {
  StatusFacts facts;
  const auto taken = TakenAsKnown(input.solution, input.policy);
  for (const SensorPose& pose : (taken ? *taken : input.solution).poses)
    facts.sensors.push_back({pose.sensor, StatusOfSensor(pose, input), DueOfSensor(pose.sensor, input)});
  std::sort(facts.sensors.begin(), facts.sensors.end(),
            [](const SensorStatus& x, const SensorStatus& y) { return x.sensor < y.sensor; });
  return facts;
}

}  // namespace rigcal::fleet
