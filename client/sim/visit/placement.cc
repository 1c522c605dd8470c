#include "client/sim/visit/placement.h"

#include <algorithm>
#include <cmath>

#include "client/sim/rig/facing.h"
#include "client/sim/rig/random.h"

namespace rigcal::sim {
namespace {

constexpr double kTiltMax = 2.5;  // of one axis, in its standard deviations: no robot falls over
constexpr std::int64_t kBetweenCaptures_ns = 10'000'000'000;
constexpr double kBurstSigma_m = 0.001, kBurstSigma_rad = 0.001;  // a robot that stands still, but not quite

double ClampedNormal(Random& random) { return std::clamp(random.Normal(), -kTiltMax, kTiltMax); }

// Level motions stay level unless a tilt is asked for.
double TiltRms_rad(const Experiment& experiment) {
  const bool is_level = experiment.options.motion != MotionKind::kFree;
  return experiment.options.tilt_rms_rad.value_or(is_level ? 0.0 : experiment.rig.motion.tilt_rms_rad);
}

std::string CaptureName(std::size_t idx, std::size_t count) {
  const std::size_t digits = std::max<std::size_t>(2, std::to_string(count).size());
  const std::string number = std::to_string(idx + 1);
  return std::string(digits - std::min(digits, number.size()), '0') + number;
}

Se3 DrawCapturePose(const Experiment& experiment, std::size_t k) {
  const std::uint64_t seed = experiment.options.seed;
  const Se3 T_world_body = DrawBodyPose(experiment, KeyOf(seed, "pose", {}, experiment.BurstOf(k)));
  if (experiment.options.disturb.burst <= 1) return T_world_body;
  Random random(KeyOf(seed, "within burst", {}, k));
  Vector6d xi;
  xi << kBurstSigma_m * random.Normals<3>(), kBurstSigma_rad * random.Normals<3>();
  return (T_world_body * Se3::Exp(xi)).Normalized();
}

}  // namespace

Se3 DrawBodyPose(const Experiment& experiment, std::uint64_t key) {
  const MotionPlan& plan = experiment.rig.motion;
  const MotionKind kind = experiment.options.motion;
  Random random(key);
  Eigen::Vector3d offset_m, rpy_rad;
  for (int k = 0; k < 3; ++k) offset_m[k] = plan.position_range_m[k] * random.Uniform(-1, 1);
  // The angle of the tilt has two axes of its own share each.
  for (int k = 0; k < 2; ++k) rpy_rad[k] = TiltRms_rad(experiment) / std::sqrt(2.0) * ClampedNormal(random);
  rpy_rad[2] = plan.yaw_range_rad * random.Uniform(-1, 1);
  if (kind == MotionKind::kSpot) offset_m.setZero();
  if (kind == MotionKind::kPlanar) offset_m.z() = 0;
  return (plan.T_world_body_start * Turned(offset_m, rpy_rad)).Normalized();
}

void PlaceCaptures(Experiment& experiment, Stamp start) {
  const auto count = static_cast<std::size_t>(experiment.options.captures.value_or(experiment.rig.motion.captures));
  for (std::size_t k = 0; k < count; ++k) {
    experiment.captures.push_back(CaptureId(CaptureName(k, count)));
    experiment.stamps_ns.push_back(start.ns + static_cast<std::int64_t>(k) * kBetweenCaptures_ns);
    experiment.T_world_body.push_back(DrawCapturePose(experiment, k));
  }
}

}  // namespace rigcal::sim
