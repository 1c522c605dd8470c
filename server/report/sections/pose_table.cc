#include <cmath>

#include "server/report/edges/tables.h"
#include "server/report/frame/retired_section.h"
#include "server/report/text/relied.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"
#include "server/report/text/unknown.h"

namespace rigcal::report {
namespace {

std::string SigmaText(const Matrix6d& covariance, int axis) {
  const double variance = covariance(axis, axis);
  if (!(variance > 0.0) || !std::isfinite(variance)) return "unknown";
  return axis < tangent::kRotation ? SigmaMm(std::sqrt(variance)) : SigmaDeg(std::sqrt(variance));
}

// What the sigmas are held against; of before policies nobody kept it.
std::string LimitOf(const formats::RevisionInput& revision, const SensorId& sensor) {
  const auto limit = ToleranceOf(revision, sensor);
  return limit ? SigmaMm(limit->m) + " mm, " + SigmaDeg(limit->rad) + " deg" : "";
}

void FillAngles(Dictionary& cells, const Eigen::Quaterniond& q) {
  const RollPitchYaw angles = RollPitchYawOf(q);
  cells.SetValue("ROLL", Deg(angles.roll));
  cells.SetValue("PITCH", Deg(angles.pitch));
  cells.SetValue("YAW", Deg(angles.yaw));
}

void FillKnown(Dictionary& row, const SensorPose& pose, bool is_reference, const std::string& limit) {
  Dictionary* known = row.AddSectionDictionary("KNOWN");
  const Eigen::Vector3d& p = pose.T_ref_sensor.p_m;
  known->SetValue("X", Mm(p.x()));
  known->SetValue("Y", Mm(p.y()));
  known->SetValue("Z", Mm(p.z()));
  FillAngles(*known, pose.T_ref_sensor.q);
  if (is_reference) return known->ShowSection("FIXED");
  known->SetValue("LIMIT", limit);
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

void AddAxisLine(Dictionary& cell, const char* section, const std::string& label, const std::string& value) {
  Dictionary* line = cell.AddSectionDictionary(section);
  line->SetValue("LABEL", label);
  line->SetValue("VALUE", value);
}

void FillShift(Dictionary& part, const AxisResult& axis, const std::string& label) {
  AddAxisLine(part, "AT", label, axis.position_m ? Mm(*axis.position_m) : "not measured");
  if (axis.sigma_m) AddAxisLine(part, "SIGMA_MM", label, SigmaMm(*axis.sigma_m));
}

// What was held is no result: no cell has it.
void FillPart(Dictionary& row, const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot,
              const std::string& limit) {
  Dictionary* part = row.AddSectionDictionary("PART");
  part->SetValue("LIMIT", limit);
  const std::vector<AxisResult> axes = AxesOf(pose, R_ref_robot);
  const bool turned = TurnsMeasured(axes);
  Dictionary* turns = part->AddSectionDictionary(turned ? "TURNED" : "TURN_OPEN");
  if (turned) FillAngles(*turns, pose.measured_part->T_ref_sensor.q);
  for (const AxisResult& axis : axes) {
    const std::string label = LabelOf(axis, R_ref_robot);
    if (!axis.turn)
      FillShift(*part, axis, label);
    else if (axis.sigma_rad)
      AddAxisLine(*part, "SIGMA_DEG", label, SigmaDeg(*axis.sigma_rad));
    else
      AddAxisLine(*turns, "OF", label, "not measured");
  }
}

}  // namespace

void FillPoses(Dictionary& page, const formats::RevisionInput& revision) {
  const auto why = WhyUnknown(revision);
  const auto& poses = revision.solution.poses;
  FillGone(page, revision.robot, revision.retired);
  FillWaysOut(page, revision);
  bool any_in_part = false;
  for (std::size_t i = 0; i < std::min(poses.size(), kPoseRowsMax); ++i) {
    Dictionary* row = page.AddSectionDictionary("POSE");
    row->SetValue("SENSOR", poses[i].sensor.str());
    if (Has(revision.basis.culprits, poses[i].sensor)) row->ShowSection("CULPRIT");
    if (poses[i].known)
      FillKnown(*row, poses[i], poses[i].sensor == revision.reference, LimitOf(revision, poses[i].sensor));
    else if (poses[i].measured_part)
      FillPart(*row, poses[i], revision.solution.R_ref_robot, LimitOf(revision, poses[i].sensor)), any_in_part = true;
    else
      ShowValue(*row, "UNKNOWN", "WHY", why.at(poses[i].sensor));
  }
  if (any_in_part)
    ShowValue(page, "IN_PART", "WHOSE", revision.solution.R_ref_robot ? "the robot" : revision.reference.str());
  if (poses.size() > kPoseRowsMax) ShowValue(page, "MORE_POSES", "COUNT", std::to_string(poses.size() - kPoseRowsMax));
}

}  // namespace rigcal::report
