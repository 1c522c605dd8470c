#include "server/fleet/findings/partial_poses.h"

#include "server/fleet/findings/failures.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

std::string FrameOf(const SensorId& reference, const SessionHeaders& headers) {
  const std::string frame = "the frame of " + reference.str();
  for (const SessionHeader* header : NewestFirst(headers))
    if (const Sensor* sensor = rigcal::SensorOf(*header, reference); sensor && sensor->kind == SensorKind::kCamera)
      return frame + " (x right, y down, z along its view)";
  return frame;
}

// Of a session, in the reference's frame.
std::optional<Se3> BodyIn(const SessionHeader& header, const SensorId& reference, SensorKind kind) {
  const Sensor* from = rigcal::SensorOf(header, reference);
  for (const Sensor& sensor : header.sensors)
    if (from && sensor.kind == kind)
      if (const auto T_ref_body = NominalPose(header, *from, sensor)) return T_ref_body;
  return std::nullopt;
}

}  // namespace

std::optional<Eigen::Matrix3d> RobotAxes(const SensorId& reference, const SessionHeaders& headers) {
  const auto is_body = [](const Sensor& sensor) {
    return sensor.kind == SensorKind::kPoseStream || sensor.kind == SensorKind::kTracker;
  };
  const std::vector<const SessionHeader*> newest = NewestFirst(headers);
  for (const SessionHeader* header : newest)
    if (const Sensor* sensor = rigcal::SensorOf(*header, reference); sensor && is_body(*sensor))
      return Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  for (const SensorKind kind : {SensorKind::kPoseStream, SensorKind::kTracker})
    for (const SessionHeader* header : newest)
      if (const auto T_ref_body = BodyIn(*header, reference, kind)) return T_ref_body->Normalized().R();
  return std::nullopt;
}

PartialPose PartialPoseOf(const SensorPose& pose, const GraphSolution& solution, const SessionHeaders& headers) {
  const SensorPose* reference = ReferenceOf(solution);
  const auto R_ref_robot = reference ? RobotAxes(reference->sensor, headers) : std::nullopt;
  const std::size_t open_count = pose.unobservable_basis.size();
  const std::vector<AxisResult> axes = AxesOf(pose, R_ref_robot);
  std::vector<std::string> names = NamesOfOpen(axes, open_count);
  for (std::string& name : names) name = InSentence(name);
  PartialPose partial;
  partial.sensor = pose.sensor;
  partial.open = List(names);
  partial.several = names.size() > 1 || open_count > 1;
  if (reference != nullptr && !R_ref_robot && OpenHaveNames(axes)) partial.frame = FrameOf(reference->sensor, headers);
  const RestSigma rest = WorstSigmaOf(axes);
  partial.sigma_m = rest.m, partial.sigma_rad = rest.rad;
  return partial;
}

}  // namespace rigcal::fleet
