#include <cmath>

#include "server/report/retired_section.h"
#include "server/report/tables.h"
#include "server/report/text.h"
#include "server/report/unknown.h"

namespace rigcal::report {
namespace {

std::string SigmaText(const Matrix6d& covariance, int axis) {
  const double variance = covariance(axis, axis);
  if (!(variance > 0.0) || !std::isfinite(variance)) return "unknown";
  return axis < tangent::kRotation ? SigmaMm(std::sqrt(variance)) : SigmaDeg(std::sqrt(variance));
}

void FillKnown(Dictionary& row, const SensorPose& pose, bool is_reference) {
  Dictionary* known = row.AddSectionDictionary("KNOWN");
  const Eigen::Vector3d& p = pose.T_ref_sensor.p_m;
  const RollPitchYaw angles = RollPitchYawOf(pose.T_ref_sensor.q);
  known->SetValue("X", Mm(p.x()));
  known->SetValue("Y", Mm(p.y()));
  known->SetValue("Z", Mm(p.z()));
  known->SetValue("ROLL", Deg(angles.roll));
  known->SetValue("PITCH", Deg(angles.pitch));
  known->SetValue("YAW", Deg(angles.yaw));
  if (is_reference) return known->ShowSection("FIXED");
  for (int axis = 0; axis < 6; ++axis) ShowValue(*known, "SIGMA", "VALUE", SigmaText(pose.covariance, axis));
}

// How each sensor is taken out; of very many, how any is.
void FillWaysOut(Dictionary& page, const formats::RevisionInput& revision) {
  const auto& poses = revision.solution.poses;
  if (poses.empty()) return;
  Dictionary* ways = page.AddSectionDictionary("WAYS_OUT");
  if (poses.size() > kWaysOutMax) return FillRetire(*ways, RetireCommand(revision.robot, SensorId("SENSOR")));
  for (const SensorPose& pose : poses) FillRetire(*ways, RetireCommand(revision.robot, pose.sensor));
}

}  // namespace

void FillPoses(Dictionary& page, const formats::RevisionInput& revision) {
  const auto why = WhyUnknown(revision);
  const auto& poses = revision.solution.poses;
  FillGone(page, revision.robot, revision.retired);
  FillWaysOut(page, revision);
  for (std::size_t i = 0; i < std::min(poses.size(), kPoseRowsMax); ++i) {
    Dictionary* row = page.AddSectionDictionary("POSE");
    row->SetValue("SENSOR", poses[i].sensor.str());
    if (poses[i].known)
      FillKnown(*row, poses[i], poses[i].sensor == revision.reference);
    else
      ShowValue(*row, "UNKNOWN", "WHY", why.at(poses[i].sensor));
  }
  if (poses.size() > kPoseRowsMax) ShowValue(page, "MORE_POSES", "COUNT", std::to_string(poses.size() - kPoseRowsMax));
}

}  // namespace rigcal::report
