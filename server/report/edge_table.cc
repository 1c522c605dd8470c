#include <algorithm>
#include <cmath>

#include "server/report/edge_axes.h"
#include "server/report/tables.h"
#include "server/report/text.h"

namespace rigcal::report {
namespace {

void FillFit(Dictionary& good, const ShownEdge& shown) {
  if (!shown.residual) return good.ShowSection("NO_FIT");
  Dictionary* fit = good.AddSectionDictionary("FIT");
  fit->SetValue("E_MM", Significant(shown.residual->e.head<3>().norm() * kMmPerMetre, 3));
  fit->SetValue("E_DEG", Significant(shown.residual->e.tail<3>().norm() * kDegPerRad, 3));
  fit->SetValue("E_SIGMA", Fixed(shown.in_sigmas, 2));
}

void FillGood(Dictionary& row, const ShownEdge& shown) {
  Dictionary* good = row.AddSectionDictionary("GOOD");
  const Edge& edge = *shown.edge;
  good->SetValue("T_MM", Mm(edge.T_a_b.p_m.norm()));
  good->SetValue("T_DEG", Deg(2.0 * std::atan2(edge.T_a_b.q.vec().norm(), std::abs(edge.T_a_b.q.w()))));
  FillFit(*good, shown);
  good->SetValue("S_MM", LargestSigma(edge.uncertainty, tangent::kTranslation));
  good->SetValue("S_DEG", LargestSigma(edge.uncertainty, tangent::kRotation));
}

std::string CapturesText(const Edge& edge) {
  if (edge.captures.empty()) return "";
  const auto used = std::count_if(edge.captures.begin(), edge.captures.end(), [](const auto& one) { return one.used; });
  return std::to_string(used) + " of " + std::to_string(edge.captures.size());
}

void FillRow(Dictionary& row, const ShownEdge& shown) {
  const Edge& edge = *shown.edge;
  const bool failed = edge.state == EdgeState::kFailed;
  Dictionary* name = row.AddSectionDictionary(shown.detailed ? "LINK" : "PLAIN");
  name->SetValue("ANCHOR", shown.anchor);
  name->SetValue("FROM", edge.frame_a.str());
  name->SetValue("TO", edge.frame_b.str());
  row.SetValue("LEVEL", failed ? "fail" : "pass");
  row.SetValue("STATE", failed ? "failed" : "good");
  row.SetValue("METHOD", edge.method);
  row.SetValue("CAPTURES", CapturesText(edge));
  if (!failed) return FillGood(row, shown);
  ShowValue(row, "FAILED", "WHY", edge.diagnoses.empty() ? "no reason was given" : edge.diagnoses.front().what);
}

}  // namespace

void FillEdges(Dictionary& page, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges) {
  for (std::size_t i = 0; i < std::min(edges.size(), kEdgeRowsMax); ++i)
    FillRow(*page.AddSectionDictionary("EDGE"), edges[i]);
  if (edges.size() > kEdgeRowsMax) ShowValue(page, "MORE_EDGES", "COUNT", std::to_string(edges.size() - kEdgeRowsMax));
  std::string note = "Residual in \xCF\x83: root mean square of the weighted residual over the observed directions.";
  if (revision.solution.dof <= 0) note += " Without a loop it is zero by construction and checks nothing.";
  page.SetValue("EDGES_NOTE", note);
}

}  // namespace rigcal::report
