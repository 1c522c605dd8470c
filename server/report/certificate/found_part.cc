#include <algorithm>

#include "server/report/certificate/conformity_text.h"
#include "server/report/certificate/figures.h"
#include "server/report/certificate/parts.h"
#include "server/report/text/relied.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

constexpr int kTestedColumns = 6;  // those that only a tested sensor fills

// "4.50 +- 0.80 (5.0)" in mm or deg.
std::string OffText(const FoundFigure& figure, double scale) {
  if (!figure.off || !figure.U) return kNoFigure;
  return AsCertainAs(*figure.off * scale, *figure.U * scale) + " \xC2\xB1 " + Significant(*figure.U * scale, 2) +
         (figure.limit ? " (" + Significant(*figure.limit * scale, 2) + ")" : "");
}

std::string LeftText(const FoundFigure& figure, double scale) {
  return figure.left && figure.U ? AsCertainAs(*figure.left * scale, *figure.U * scale) : kNoFigure;
}

// Of a sensor that is known in part: the policy needs no more of it.
bool MayLackAxes(const SensorId& sensor, const formats::RevisionInput& revision) {
  const auto pose = std::find_if(revision.solution.poses.begin(), revision.solution.poses.end(),
                                 [&](const SensorPose& one) { return one.sensor == sensor; });
  return pose != revision.solution.poses.end() && pose->measured_part && LacksOnlyNotNeeded(*pose, revision);
}

std::vector<CertificateCell> RowOf(const SensorFound& found, const formats::RevisionInput& revision) {
  const std::string id = found.sensor.str();
  if (!IsTested(found)) return {{id}, {WordFor(found), kTestedColumns}};
  const bool needs_all = !revision.policy || !MayLackAxes(found.sensor, revision);
  const FoundFigures figures = FoundFiguresOf(found, ToleranceOf(revision, found.sensor), needs_all);
  const std::string drifted = WordFor(found) + (found.or_else.empty() ? "" : ", or " + found.or_else.str() + " has");
  return {{id},
          {drifted},
          {OffText(figures.shift, kMmPerMetre)},
          {OffText(figures.turn, kDegPerRad)},
          {WithinText(figures.decision, IsReliedOn(found.sensor, revision.verdict, revision.basis))},
          {LeftText(figures.shift, kMmPerMetre)},
          {LeftText(figures.turn, kDegPerRad)}};
}

}  // namespace

CertificatePart FoundPart(const ReportInput& input) {
  CertificatePart part{"As found, as left"};
  const std::optional<AsFound>& found = input.as_found;
  if (!found) return part.text = {"Nothing was in use before, or the revision has no session."}, part;
  part.text = {found->text.empty() ? found->why_not : found->text};
  if (!found->why_not.empty() || found->sensors.empty()) return part;
  const std::string limit = input.revision.policy ? " (limit)" : "";
  part.table.columns = {{"Sensor"},        {"found"},         {"off by mm" + limit, true}, {"off by deg" + limit, true},
                        {"within limits"}, {"left mm", true}, {"left deg", true}};
  for (const SensorFound& sensor : found->sensors) part.table.rows.push_back(RowOf(sensor, input.revision));
  part.notes = {"Seen from " + found->relative_to.str() +
                ", on the worst of the axes that were measured; \xC2\xB1 U, U = 2 sigma of the change, scatter between "
                "visits included. "
                "Decision rule, with U as guard band: yes where off + U is at most the limit on each of them, no where "
                "off - U is "
                "beyond it, else not decided. Left: off after the update."};
  return part;
}

}  // namespace rigcal::report
