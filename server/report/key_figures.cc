#include "server/report/key_figures.h"

#include <algorithm>
#include <cmath>

#include "server/report/text.h"

namespace rigcal::report {
namespace {

struct Figure {
  std::string name, value, tone;
  std::vector<std::string> details;
};

const char* kArrow = " \xE2\x86\x92 ";

void Add(Dictionary& page, const Figure& figure) {
  Dictionary* card = page.AddSectionDictionary("FIGURE");
  card->SetValue("NAME", figure.name);
  card->SetValue("VALUE", figure.value);
  card->SetValue("TONE", figure.tone);
  for (const std::string& detail : figure.details) ShowValue(*card, "DETAIL", "TEXT", detail);
}

std::string RmsText(double square, double scale) { return Significant(std::sqrt(std::max(square, 0.0)) * scale, 3); }

Figure GlobalErrorFigure(const GraphSolution& solution) {
  const GlobalError &before = solution.before, &after = solution.after;
  if (solution.dof <= 0)
    return {"E_global, before" + std::string(kArrow) + "after",
            Significant(after.total, 3),
            "warn",
            {"No loop in the graph: every edge fits by construction, nothing checks the result."}};
  Figure figure{"E_global, m\xC2\xB2 + rad\xC2\xB2, before" + std::string(kArrow) + "after",
                Significant(before.total, 3) + kArrow + Significant(after.total, 3),
                "",
                {}};
  figure.details.push_back("translation rms " + RmsText(before.translation_m2, kMmPerMetre) + kArrow +
                           RmsText(after.translation_m2, kMmPerMetre) + " mm, rotation rms " +
                           RmsText(before.rotation_rad2, kDegPerRad) + kArrow +
                           RmsText(after.rotation_rad2, kDegPerRad) + " deg");
  if (after.total > before.total)
    figure.details.push_back(
        "It rose, and may: E_global counts every edge alike, while the solution trusts certain edges "
        "more than uncertain ones. What it makes small is the weighted cost.");
  return figure;
}

Figure CostFigure(const GraphSolution& solution) {
  const std::string name = "Weighted cost per degree of freedom";
  if (!solution.converged) return {name, "not converged", "fail", {"The numbers of this revision are not an optimum."}};
  if (solution.dof <= 0) return {name, "no loop", "warn", {"Nothing is measured twice."}};
  return {name,
          Significant(solution.cost / solution.dof, 3),
          "",
          {Significant(solution.cost, 5) + " / " + std::to_string(solution.dof) +
           "; near 1 where edges are independent. Edges of one session share captures: then it is no verdict."}};
}

Figure EdgeFigure(const std::vector<Edge>& edges) {
  const auto failed = static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const Edge& edge) { return edge.state == EdgeState::kFailed; }));
  return {"Edges",
          std::to_string(edges.size() - failed) + " good, " + std::to_string(failed) + " failed",
          failed > 0 ? "fail" : "pass",
          {}};
}

Figure SensorFigure(const std::vector<SensorPose>& poses) {
  const auto known = static_cast<std::size_t>(
      std::count_if(poses.begin(), poses.end(), [](const SensorPose& pose) { return pose.known; }));
  return {"Sensors",
          std::to_string(known) + " known, " + std::to_string(poses.size() - known) + " unknown",
          known < poses.size() ? "warn" : "pass",
          {}};
}

Figure SigmaFigure(const formats::RevisionInput& revision) {
  double sigma_m = 0.0, sigma_rad = 0.0;
  const SensorPose* worst = nullptr;
  for (const SensorPose& pose : revision.solution.poses) {
    if (!pose.known || pose.sensor == revision.reference) continue;
    const auto sigma = pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt().eval();
    const double here_m = sigma.head<3>().maxCoeff();
    sigma_rad = std::max(sigma_rad, sigma.tail<3>().maxCoeff());
    if (!worst || here_m > sigma_m) worst = &pose;
    sigma_m = std::max(sigma_m, here_m);
  }
  if (!worst) return {"Largest \xCF\x83 of a sensor", "none known", "warn", {}};
  return {"Largest \xCF\x83 of a sensor",
          SigmaMm(sigma_m) + " mm, " + SigmaDeg(sigma_rad) + " deg",
          "",
          {"position: " + worst->sensor.str()}};
}

}  // namespace

void FillKeyFigures(Dictionary& page, const formats::RevisionInput& revision) {
  Add(page, SensorFigure(revision.solution.poses));
  Add(page, EdgeFigure(revision.edges));
  Add(page, SigmaFigure(revision));
  Add(page, GlobalErrorFigure(revision.solution));
  Add(page, CostFigure(revision.solution));
}

void FillNotes(Dictionary& page, const formats::RevisionInput& revision) {
  constexpr std::size_t kNotesMax = 20;
  const auto& diagnoses = revision.solution.diagnoses;
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
