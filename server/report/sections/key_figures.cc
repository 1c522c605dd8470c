#include "server/report/sections/key_figures.h"

#include <algorithm>
#include <cmath>

#include "server/model/edges/past.h"
#include "server/report/frame/figure.h"
#include "server/report/text/age.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/relied.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

const char* kArrow = " \xE2\x86\x92 ";

std::size_t CountIf(const std::vector<ShownEdge>& edges, bool (*is)(const Edge&)) {
  return static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [is](const ShownEdge& shown) { return is(*shown.edge); }));
}

std::string RmsText(double square, double scale) { return Significant(std::sqrt(std::max(square, 0.0)) * scale, 3); }

Figure GlobalErrorFigure(const GraphSolution& solution) {
  const GlobalError &before = solution.before, &after = solution.after;
  // It is what arithmetic leaves over, or, of edges to sensors without a pose, nothing at all.
  if (solution.dof <= 0)
    return {
        "E_global", "no loop", "warn", {"Every edge that is solved fits by construction: nothing checks the result."}};
  Figure figure{"E_global, m\xC2\xB2 + rad\xC2\xB2, before" + std::string(kArrow) + "after",
                Significant(before.total, 3) + kArrow + Significant(after.total, 3),
                "",
                {}};
  figure.details.push_back("edges off the rig by " + RmsText(before.translation_m2, kMmPerMetre) + kArrow +
                           RmsText(after.translation_m2, kMmPerMetre) + " mm and " +
                           RmsText(before.rotation_rad2, kDegPerRad) + kArrow +
                           RmsText(after.rotation_rad2, kDegPerRad) + " deg, rms");
  if (after.total > before.total)
    figure.details.push_back(
        "It rose, and may: E_global counts every edge alike, while the solution trusts certain edges "
        "more than uncertain ones. What it makes small is the weighted cost.");
  return figure;
}

Figure CostFigure(const GraphSolution& solution) {
  const std::string name = "\xCF\x87\xC2\xB2 per degree of freedom";
  if (!solution.converged) return {name, "not converged", "fail", {"The numbers of this revision are not an optimum."}};
  if (solution.dof <= 0) return {name, "no loop", "warn", {"Nothing is measured twice."}};
  return {
      name,
      Significant(solution.cost / solution.dof, 3),
      "",
      {Significant(solution.cost, 5) + " / " + std::to_string(solution.dof) +
       ". Near 1 where edges are independent; edges of one session share captures, so it decides nothing by itself."}};
}

std::string PairText(const Edge& edge) { return edge.frame_a.str() + kArrow + edge.frame_b.str(); }

// How long it may be relied on is for the verdict to say: this is when it was measured, beside the limit.
Figure MeasuredFigure(const Validity& validity) {
  if (!validity.calibrated_at) return {"Measured", "not known", "warn", {"nothing ties all sensors together"}};
  return {"Measured", DayText(*validity.calibrated_at), "", {AgeLimitText(validity)}};
}

// The first in the page's order: a failed one, else the worst fit.
Figure WorstEdgeFigure(const std::vector<ShownEdge>& edges, int dof) {
  const std::size_t failed = CountIf(edges, HasFailed), past = CountIf(edges, IsPast);
  const std::string counts = std::to_string(edges.size() - failed - past) + " good, " + std::to_string(failed) +
                             " failed" + (past > 0 ? ", " + std::to_string(past) + " past" : "");
  if (edges.empty()) return {"Worst edge", "no edges", "warn", {}};
  const ShownEdge& worst = edges.front();
  if (failed > 0) return {"Worst edge", PairText(*worst.edge), "fail", {"failed", counts}};
  if (dof <= 0) return {"Worst edge", "none is checked", "warn", {"Without a loop every edge fits.", counts}};
  return {"Worst edge",
          PairText(*worst.edge),
          SigmasClass(worst.in_sigmas),
          {SigmasText(worst.in_sigmas) + " \xCF\x83 off the solution", counts}};
}

// The sensor whose position is least certain.
const SensorPose* LeastCertain(const formats::RevisionInput& revision) {
  const SensorPose* worst = nullptr;
  double sigma_m = 0.0;
  for (const SensorPose& pose : revision.solution.poses) {
    if (!pose.known || pose.sensor == revision.reference) continue;
    const double here_m = std::sqrt(std::max(pose.covariance.diagonal().head<3>().maxCoeff(), 0.0));
    if (!worst || here_m > sigma_m) worst = &pose;
    sigma_m = std::max(sigma_m, here_m);
  }
  return worst;
}

// Known is what the verdict relies on: what else has a pose is not verified.
std::string KnownCounts(const formats::RevisionInput& revision) {
  const std::vector<SensorPose>& poses = revision.solution.poses;
  const auto known = std::count_if(poses.begin(), poses.end(), [](const SensorPose& pose) { return pose.known; });
  const auto relied = std::count_if(poses.begin(), poses.end(), [&](const SensorPose& pose) {
    return pose.known && IsReliedOn(pose.sensor, revision.verdict, revision.basis);
  });
  const auto in_part =
      std::count_if(poses.begin(), poses.end(), [](const SensorPose& pose) { return pose.measured_part.has_value(); });
  const auto unknown = static_cast<std::ptrdiff_t>(poses.size()) - known - in_part;
  return std::to_string(relied) + " known, " +
         (known > relied ? std::to_string(known - relied) + " not verified, " : "") +
         (in_part > 0 ? std::to_string(in_part) + " in part, " : "") + std::to_string(unknown) + " unknown";
}

// Nobody measured a direction of it, and it is not among those of which nothing is known.
Figure InPartFigure(const SensorPose& pose, const std::optional<Eigen::Matrix3d>& R_ref_robot,
                    const std::string& counts) {
  std::string open;
  for (const std::string& name : NamesOfOpen(AxesOf(pose, R_ref_robot), pose.unobservable_basis.size()))
    open += (open.empty() ? "" : ", ") + name;
  return {"Least certain sensor", pose.sensor.str(), "warn", {open + " not measured", counts}};
}

Figure WorstSensorFigure(const formats::RevisionInput& revision) {
  const auto& poses = revision.solution.poses;
  const std::string counts = KnownCounts(revision);
  const auto lost =
      std::find_if(poses.begin(), poses.end(), [](const SensorPose& pose) { return pose.Placed() == nullptr; });
  if (lost != poses.end())
    return {"Least certain sensor", lost->sensor.str(), "warn", {"its pose is not known", counts}};
  const auto in_part = std::find_if(poses.begin(), poses.end(), [](const SensorPose& pose) { return !pose.known; });
  if (in_part != poses.end()) return InPartFigure(*in_part, revision.solution.R_ref_robot, counts);
  const SensorPose* worst = LeastCertain(revision);
  if (!worst) return {"Least certain sensor", "none known", "warn", {counts}};
  const Vector6d sigma = worst->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  std::string limit_mm, limit_deg;
  if (const auto limit = ToleranceOf(revision, worst->sensor))
    limit_mm = " (limit " + SigmaMm(limit->m) + " mm)", limit_deg = " (limit " + SigmaDeg(limit->rad) + " deg)";
  return {"Least certain sensor",
          worst->sensor.str(),
          "",
          {"\xC2\xB1 " + SigmaMm(sigma.head<3>().maxCoeff()) + " mm" + limit_mm + ", \xC2\xB1 " +
               SigmaDeg(sigma.tail<3>().maxCoeff()) + " deg" + limit_deg + " (1 \xCF\x83)",
           counts}};
}

// The first letter's size apart: a verdict is a sentence, a diagnosis part of one.
bool Says(const std::string& sentence, const std::string& part) {
  return part.size() > 1 && sentence.find(part.substr(1)) != std::string::npos;
}

// Of a sensor that was measured in part the solver names the open direction as a vector; the table of sensors says it
// in words.
bool IsToldInWords(const Diagnosis& diagnosis, const std::vector<SensorPose>& poses) {
  return diagnosis.code == "not_observable" && std::any_of(poses.begin(), poses.end(), [&](const SensorPose& pose) {
           return pose.measured_part && diagnosis.what.find(" sensor " + pose.sensor.str() + " ") != std::string::npos;
         });
}

// What the verdict already says stands above, large.
std::vector<Diagnosis> NotInVerdict(const formats::RevisionInput& revision) {
  std::vector<Diagnosis> rest;
  for (const Diagnosis& diagnosis : revision.solution.diagnoses)
    if (!Says(revision.verdict.why, diagnosis.what) && !IsToldInWords(diagnosis, revision.solution.poses))
      rest.push_back(diagnosis);
  return rest;
}

}  // namespace

void FillKeyFigures(Dictionary& page, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges,
                    const Validity& validity) {
  Dictionary& figures = AddFigures(page);
  const std::optional<Figure> decided = DecidingFigureOf(revision.verdict, revision.basis);
  if (decided) AddFigure(figures, *decided);
  AddFigure(figures, MeasuredFigure(validity));
  AddFigure(figures, WorstSensorFigure(revision));
  if (!decided) AddFigure(figures, WorstEdgeFigure(edges, revision.solution.dof));
  Dictionary& whole = AddFigures(page, "WHOLE_FIGURES", "The solution as a whole");
  AddFigure(whole, GlobalErrorFigure(revision.solution));
  AddFigure(whole, CostFigure(revision.solution));
}

void FillNotes(Dictionary& page, const formats::RevisionInput& revision) {
  constexpr std::size_t kNotesMax = 20;
  const std::vector<Diagnosis> diagnoses = NotInVerdict(revision);
  if (diagnoses.empty()) return;
  Dictionary* notes = page.AddSectionDictionary("NOTES");
  for (std::size_t i = 0; i < std::min(diagnoses.size(), kNotesMax); ++i) {
    Dictionary* note = notes->AddSectionDictionary("NOTE");
    note->SetValue("WHAT", diagnoses[i].what);
    note->SetValue("CURE", diagnoses[i].cure);
  }
  if (diagnoses.size() > kNotesMax)
    notes->AddSectionDictionary("NOTE")->SetValue(
        "WHAT", std::to_string(diagnoses.size() - kNotesMax) + " more notes are in revision.json.");
}

}  // namespace rigcal::report
