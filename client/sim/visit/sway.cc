#include "client/sim/visit/sway.h"

#include <cmath>

#include "client/sim/rig/facing.h"
#include "client/sim/rig/random.h"

namespace rigcal::sim {
namespace {

constexpr double kSwayLeast_Hz = 0.3, kSwayMost_Hz = 0.8;

// A coordinate of a harmonic motion that is 0 at the capture: its velocity there, and its acceleration.
struct Harmonic {
  double velocity = 0.0, acceleration = 0.0, rate_rad_s = 1.0;

  [[nodiscard]] double At(double since_s) const {
    const double angle = rate_rad_s * since_s;
    return velocity * std::sin(angle) / rate_rad_s + acceleration * (1 - std::cos(angle)) / (rate_rad_s * rate_rad_s);
  }
};

Harmonic DrawHarmonic(double rms_per_s, Random& random) {
  Harmonic one;
  one.rate_rad_s = 2 * M_PI * random.Uniform(kSwayLeast_Hz, kSwayMost_Hz);
  one.velocity = rms_per_s * random.Normal();
  one.acceleration = rms_per_s * one.rate_rad_s * random.Normal();
  return one;
}

// The flange of a robot behind the plate that it carries.
const Se3 kPlateFlange{{0.03, -0.02, 0.06}, Eigen::Quaterniond(0.9, 0.1, -0.2, 0.3742).normalized()};

Se3 SwayingPose(const Experiment& experiment, const RigSensor& tracker, std::size_t capture_idx, double since_s) {
  const Se3 at_capture = experiment.T_world_sensor(tracker.id, capture_idx);
  if (!IsSwaying(experiment)) return at_capture;
  const Se3 T_body_tracker = experiment.T_body_sensor(tracker.id, capture_idx);
  const Se3 sway = SwayOf(experiment, capture_idx, since_s - experiment.options.disturb.pose_clock_late_s);
  return at_capture * T_body_tracker.Inverse() * sway * T_body_tracker;
}

}  // namespace

bool IsSwaying(const Experiment& experiment) {
  const Displacement& speed = experiment.options.disturb.sway_per_s;
  return speed.m > 0 || speed.rad > 0;
}

Se3 SwayOf(const Experiment& experiment, std::size_t capture_idx, double since_s) {
  if (!IsSwaying(experiment)) return {};
  const MotionKind kind = experiment.options.motion;
  const Displacement& speed = experiment.options.disturb.sway_per_s;
  Random random(KeyOf(experiment.options.seed, "sway", {}, capture_idx));
  Eigen::Vector3d offset_m, rpy_rad;
  for (int i = 0; i < 3; ++i) offset_m[i] = DrawHarmonic(speed.m / std::sqrt(3.0), random).At(since_s);
  for (int i = 0; i < 3; ++i) rpy_rad[i] = DrawHarmonic(speed.rad / std::sqrt(3.0), random).At(since_s);
  if (kind != MotionKind::kFree) offset_m.z() = rpy_rad.x() = rpy_rad.y() = 0;
  if (kind == MotionKind::kSpot) offset_m.setZero();
  return Turned(offset_m, rpy_rad);
}

Se3 ToldByTracker(const Experiment& experiment, const RigSensor& tracker, std::size_t capture_idx, double since_s) {
  const Se3 T_world_tracker = SwayingPose(experiment, tracker, capture_idx, since_s);
  for (const RigBoard& board : experiment.rig.boards)
    if (board.target.mounted_on == tracker.id) return T_world_tracker.Inverse() * board.T_world_plate * kPlateFlange;
  const auto drift = experiment.T_told_world.find(tracker.id);
  if (drift == experiment.T_told_world.end() || drift->second.empty()) return T_world_tracker;
  return drift->second[capture_idx] * T_world_tracker;
}

}  // namespace rigcal::sim
