#include <algorithm>

#include "server/report/certificate/conformity_text.h"
#include "server/report/certificate/figures.h"
#include "server/report/certificate/parts.h"
#include "server/report/text/relied.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"
#include "server/report/text/unknown.h"

namespace rigcal::report {
namespace {

constexpr int kPoseColumns = 6, kCertaintyColumns = 6;

using Cells = std::vector<CertificateCell>;

void AddPose(const Se3& T_ref_sensor, Cells& row) {
  const RollPitchYaw angles = RollPitchYawOf(T_ref_sensor.q);
  for (int axis = 0; axis < 3; ++axis) row.push_back({Mm(T_ref_sensor.p_m(axis))});
  for (const double angle : {angles.roll, angles.pitch, angles.yaw}) row.push_back({Deg(angle)});
}

// "2.23 (10)"
std::string CoverageText(const CertifiedPose& certified, double dof) {
  if (!certified.k) return kNoFigure;
  return Fixed(*certified.k, 2) + " (" + (dof > 0.0 ? Fixed(dof, dof < 10.0 ? 1 : 0) : "inf") + ")";
}

void AddCertainty(const SensorPose& pose, const formats::RevisionInput& revision, bool relied_on, Cells& row) {
  const CertifiedPose certified = CertifiedPoseOf(pose, revision);
  const auto with_limit = [](const CertifiedFigure& figure, std::string (*text)(double)) {
    return (figure.sigma ? text(*figure.sigma) : "not known") + (figure.limit ? " (" + text(*figure.limit) + ")" : "");
  };
  row.push_back({with_limit(certified.shift, SigmaMm)});
  row.push_back({with_limit(certified.turn, SigmaDeg)});
  row.push_back({CoverageText(certified, pose.dof)});
  row.push_back({certified.shift.U ? SigmaMm(*certified.shift.U) : kNoFigure});
  row.push_back({certified.turn.U ? SigmaDeg(*certified.turn.U) : kNoFigure});
  row.push_back({WithinText(certified.decision, relied_on)});
}

// "forward 412.30 mm, sideways -1.20 mm, roll 0.100, pitch 0.000, yaw 90.000 deg; the height was not measured"; what
// was held along the rest is no result.
std::string PartText(const SensorPose& pose, const std::string& why, bool relied_on,
                     const formats::RevisionInput& revision) {
  const auto& R_ref_robot = revision.solution.R_ref_robot;
  const std::vector<AxisResult> axes = AxesOf(pose, R_ref_robot);
  std::string text;
  for (const AxisResult& axis : axes)
    if (axis.position_m && axis.sigma_m)
      text += (text.empty() ? "" : ", ") + LabelOf(axis, R_ref_robot) + " " + Mm(*axis.position_m) + " mm";
  if (TurnsMeasured(axes)) {
    const RollPitchYaw angles = RollPitchYawOf(pose.measured_part->T_ref_sensor.q);
    text += (text.empty() ? "" : ", ") + ("roll " + Deg(angles.roll)) + ", pitch " + Deg(angles.pitch) + ", yaw " +
            Deg(angles.yaw) + " deg";
  }
  text += (text.empty() ? "" : "; ") + why;
  if (relied_on && LacksOnlyNotNeeded(pose, revision))
    text += pose.unobservable_basis.size() > 1 ? "; the policy does not need them" : "; the policy does not need it";
  return text;
}

Cells RowOf(const SensorPose& pose, const std::string& why, const formats::RevisionInput& revision) {
  Cells row = {{pose.sensor.str()}};
  const bool relied_on = IsReliedOn(pose.sensor, revision.verdict, revision.basis);
  if (!pose.known && !pose.measured_part) {
    row.push_back({"unknown: " + why, kPoseColumns + kCertaintyColumns});
    return row;
  }
  pose.known ? AddPose(pose.T_ref_sensor, row)
             : row.push_back({PartText(pose, why, relied_on, revision), kPoseColumns});
  if (pose.sensor == revision.reference)
    row.push_back({"reference: fixed, without uncertainty", kCertaintyColumns});
  else
    AddCertainty(pose, revision, relied_on, row);
  return row;
}

CertificateTable Columns(bool limits) {
  const std::string limit = limits ? " (limit)" : "";
  CertificateTable table{{{"Sensor"}}};
  for (const char* title : {"x mm", "y mm", "z mm", "roll deg", "pitch deg", "yaw deg"})
    table.columns.push_back({title, true});
  table.columns.push_back({"sigma mm" + limit, true});
  table.columns.push_back({"sigma deg" + limit, true});
  for (const char* title : {"k (dof)", "U mm", "U deg"}) table.columns.push_back({title, true});
  table.columns.push_back({"within limits"});
  return table;
}

}  // namespace

bool LacksOnlyNotNeeded(const SensorPose& pose, const formats::RevisionInput& revision) {
  if (!revision.policy) return false;
  const std::set<std::string> not_needed = NotNeededOf(revision.policy->policy, pose.sensor);
  const auto& R_ref_robot = revision.solution.R_ref_robot;
  const std::vector<std::string> open = NamesOfOpen(AxesOf(pose, R_ref_robot), pose.unobservable_basis.size());
  return std::all_of(open.begin(), open.end(), [&](const std::string& name) {
    return not_needed.contains(R_ref_robot ? name : FrameResultOf(name, revision.reference));
  });
}

CertificatePart PosesPart(const ReportInput& input) {
  const formats::RevisionInput& revision = input.revision;
  CertificatePart part{"Sensors in the frame of " + revision.reference.str()};
  part.table = Columns(revision.policy.has_value());
  const auto why = WhyUnknown(revision);
  bool by_noise = false;
  for (const SensorPose& pose : revision.solution.poses) {
    part.table.rows.push_back(RowOf(pose, pose.known ? "" : why.at(pose.sensor), revision));
    by_noise |= pose.known && pose.sensor != revision.reference && pose.dof == 0.0;
  }
  part.notes.push_back(
      "Rotation R = Rz(yaw) Ry(pitch) Rx(roll). sigma: one standard deviation of the axis that is known worst. U = k "
      "sigma holds the value with a probability of 95 %: k is Student's t by the degrees of freedom (dof) behind the "
      "sensor's covariance." +
      std::string(by_noise ? " inf: sigma follows from the noise, or was given." : ""));
  if (revision.policy)
    part.notes.push_back(
        "Decision rule, with U as guard band: yes where U is at most the limit, no where sigma alone is beyond it, "
        "else not decided. Not verified: U is small enough, but the verdict does not rely on that sensor.");
  return part;
}

}  // namespace rigcal::report
