// Robots whose sensors are drawn at one place and found at another.
#pragma once

#include <string>
#include <vector>

#include "tests/unit/fleet/causes/visit.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {

inline constexpr double kDegree = M_PI / 180;

inline Se3 At(const Eigen::Vector3d& p_m, double yaw_rad = 0.0) {
  Se3 T;
  T.p_m = p_m;
  T.q = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
  return T;
}

// A drawing, and where its sensors were found; the first is the reference.
struct Drawn {
  Visit visit = Visit(StereoBoard());
  GraphSolution solution = SolutionOf({}, {});

  void Add(const std::string& name, SensorKind kind, const Se3& drawn, const Se3& measured, double sigma_m = 0.001) {
    visit.AddSensor(name, kind);
    const bool reference = visit.header.sensors.size() == 1;
    if (!reference) {
      visit.header.sensors.back().T_ref_nominal = drawn;
      visit.AddGood(visit.header.reference.str(), name);
    }
    SensorPose pose = PoseOf(name, true, reference ? 0.0 : sigma_m * sigma_m);
    pose.T_ref_sensor = measured;
    solution.poses.push_back(pose);
  }
  // The newest sensor: nobody measured it along this, right tangent at it, and its pose holds it so many times beside
  // where it is.
  void LeaveOpen(const Vector6d& direction, double held = 0.0) {
    SensorPose& pose = solution.poses.back();
    if (pose.known) pose.measured_part = MeasuredPart{pose.T_ref_sensor, pose.covariance};
    pose.known = false;
    pose.T_ref_sensor = {};
    pose.measured_part->T_ref_sensor = pose.measured_part->T_ref_sensor * Se3::Exp(held * direction);
    pose.unobservable_basis.push_back(direction);
  }
  [[nodiscard]] std::vector<RootCause> Causes() const { return visit.Causes(solution); }
  [[nodiscard]] Verdict Judge() const { return visit.Judge(solution); }
};

inline Drawn WithReference(SensorKind kind = SensorKind::kLidar) {
  Drawn drawn;
  drawn.Add("base", kind, {}, {});
  return drawn;
}

}  // namespace rigcal::fleet
