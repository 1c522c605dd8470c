#include "server/fleet/findings/not_needed.h"

#include <algorithm>
#include <map>

#include "server/fleet/findings/failures.h"
#include "server/fleet/findings/partial_poses.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

// The cosine of 5 degrees. What is open lies beside its axis by so much at most: 30 mm by which the nominal height is
// off are 3 mm in what is told as forward or sideways.
constexpr double kAlongAxis = 0.99619469809174555;

bool IsAlongAxis(const AxisResult& axis, const Eigen::Matrix3d& axes) {
  return (axes.transpose() * axis.direction).cwiseAbs().maxCoeff() >= kAlongAxis;
}

// As a policy names it: an axis of the robot by itself, one of a frame with the sensor whose frame it is.
std::string NeedOf(const AxisResult& axis, const GraphSolution& solution) {
  const SensorPose* reference = ReferenceOf(solution);
  if (solution.R_ref_robot || reference == nullptr) return axis.name;
  return FrameResultOf(axis.name, reference->sensor);
}

bool IsEnough(const SensorPose& pose, const GraphSolution& solution, const Policy& policy) {
  if (pose.known || !pose.measured_part || pose.unobservable_basis.empty()) return false;
  const std::vector<AxisResult> axes = AxesOf(pose, solution.R_ref_robot);
  return OpenHaveNames(axes) && std::all_of(axes.begin(), axes.end(), [&](const AxisResult& axis) {
           return axis.measured() || IsNotNeeded(axis, pose.sensor, solution, policy);
         });
}

}  // namespace

bool IsNotNeeded(const AxisResult& axis, const SensorId& sensor, const GraphSolution& solution, const Policy& policy) {
  return IsAlongAxis(axis, solution.R_ref_robot.value_or(Eigen::Matrix3d::Identity())) &&
         NotNeededOf(policy, sensor).contains(NeedOf(axis, solution));
}

std::optional<GraphSolution> TakenAsKnown(const GraphSolution& solution, const Policy& policy) {
  std::optional<GraphSolution> taken;
  for (std::size_t k = 0; k < solution.poses.size(); ++k) {
    if (!IsEnough(solution.poses[k], solution, policy)) continue;
    if (!taken) taken = solution;
    SensorPose& pose = taken->poses[k];
    pose.known = true;
    pose.T_ref_sensor = pose.measured_part->T_ref_sensor;
    pose.covariance = pose.measured_part->covariance;
    pose.measured_part.reset();  // what is open stays told: along it nothing is held against a drawing
  }
  return taken;
}

std::string NotNeededRemark(const GraphSolution& solution, const Policy& policy, const SessionHeaders& headers) {
  std::map<std::string, std::vector<PartialPose>> alike;  // by what is open
  for (const SensorPose& pose : solution.poses) {
    if (!IsEnough(pose, solution, policy)) continue;
    PartialPose partial = PartialPoseOf(pose, solution, headers);
    alike[partial.open].push_back(std::move(partial));
  }
  std::string remark;
  for (const auto& [open, poses] : alike) {
    std::vector<SensorId> sensors;
    double sigma_m = 0.0, sigma_rad = 0.0;
    for (const PartialPose& pose : poses) {
      sensors.push_back(pose.sensor);
      sigma_m = std::max(sigma_m, pose.sigma_m.value_or(0.0));
      sigma_rad = std::max(sigma_rad, pose.sigma_rad.value_or(0.0));
    }
    remark += (remark.empty() ? "" : "; ") + open + " of " + List(sensors) +
              (poses.front().several ? " were not measured, and the policy does not need them"
                                     : " was not measured, and the policy does not need it") +
              "; the rest was, to " + SigmaText(sigma_m, sigma_rad);
  }
  return remark;
}

}  // namespace rigcal::fleet
