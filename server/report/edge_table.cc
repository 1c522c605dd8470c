#include <algorithm>
#include <cmath>

#include "server/report/edge_axes.h"
#include "server/report/edge_fit.h"
#include "server/report/influence.h"
#include "server/report/tables.h"
#include "server/report/text.h"

namespace rigcal::report {
namespace {

std::string ThreeNumbers(const Eigen::Vector3d& values, double scale) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) text += (text.empty() ? "" : " / ") + Significant(values(axis) * scale, 2);
  return text;
}

void FillFit(Dictionary& good, const ShownEdge& shown) {
  if (!shown.residual) return good.ShowSection("NO_FIT");
  Dictionary* fit = good.AddSectionDictionary("FIT");
  const Vector6d& e = shown.residual->e;
  fit->SetValue("E_MM", ThreeNumbers(e.head<3>(), kMmPerMetre));
  fit->SetValue("E_MM_KEY", Significant(e.head<3>().norm() * kMmPerMetre, 6));
  fit->SetValue("E_DEG", ThreeNumbers(e.tail<3>(), kDegPerRad));
  fit->SetValue("E_DEG_KEY", Significant(e.tail<3>().norm() * kDegPerRad, 6));
  fit->SetValue("E_SIGMA", Fixed(shown.in_sigmas, 2));
}

void FillTest(Dictionary& good, const ReportInput& input, const EdgeId& edge) {
  const auto found = input.limits.find(edge);
  if (found == input.limits.end() || !(found->second.limit > 0.0)) return good.ShowSection("NO_TEST");
  Dictionary* test = good.AddSectionDictionary("TEST");
  test->SetValue("T2", Significant(found->second.statistic, 3));
  test->SetValue("LIMIT", Significant(found->second.limit, 3));
  if (found->second.statistic > found->second.limit) test->ShowSection("BEYOND");
}

void FillInfluenceCell(Dictionary& good, const ReportInput& input, const Edge& edge) {
  const auto blocks = input.blocks.find(edge.id);
  if (blocks == input.blocks.end() || blocks->second.empty()) return good.ShowSection("NO_INFLUENCE");
  const Influence largest = LargestInfluence(blocks->second, edge.uncertainty);
  Dictionary* influence = good.AddSectionDictionary("INFLUENCE");
  influence->SetValue("MM", Significant(largest.position_m * kMmPerMetre, 2));
  influence->SetValue("CAPTURE", largest.block_id);
}

// What the solution without this edge would be.
void FillWithout(Dictionary& good, const Influences& influences, const EdgeId& edge) {
  const EdgeInfluence* found = InfluenceOf(influences, edge);
  if (found == nullptr || !found->checked || found->most_moved.empty())
    return ShowValue(good, "NO_WITHOUT", "WHY", found != nullptr && !found->checked ? "nothing checks it" : "");
  Dictionary* without = good.AddSectionDictionary("WITHOUT");
  without->SetValue("MM", Significant(found->move.head<3>().norm() * kMmPerMetre, 2));
  without->SetValue("DEG", Significant(found->move.tail<3>().norm() * kDegPerRad, 2));
  without->SetValue("SIGMAS", Fixed(found->move_sigmas, 2));
  without->SetValue("SENSOR", found->most_moved.str());
}

void FillGood(Dictionary& row, const ReportInput& input, const ShownEdge& shown) {
  Dictionary* good = row.AddSectionDictionary("GOOD");
  const Edge& edge = *shown.edge;
  FillFit(*good, shown);
  FillTest(*good, input, edge.id);
  good->SetValue("S_MM", ThreeSigmas(edge.uncertainty, tangent::kTranslation));
  good->SetValue("S_MM_KEY", SigmaKey(edge.uncertainty, tangent::kTranslation));
  good->SetValue("S_DEG", ThreeSigmas(edge.uncertainty, tangent::kRotation));
  good->SetValue("S_DEG_KEY", SigmaKey(edge.uncertainty, tangent::kRotation));
  good->SetValue("SOURCE", NameOf(edge.uncertainty.source));
  FillInfluenceCell(*good, input, edge);
  FillWithout(*good, input.revision.solution.influences, edge.id);
}

std::ptrdiff_t UsedCount(const Edge& edge) {
  return std::count_if(edge.captures.begin(), edge.captures.end(), [](const auto& one) { return one.used; });
}

std::string CapturesText(const Edge& edge) {
  if (edge.captures.empty()) return "";
  return std::to_string(UsedCount(edge)) + " of " + std::to_string(edge.captures.size());
}

void FillState(Dictionary& row, const ShownEdge& shown, const Contradictions& contradictions) {
  const bool failed = shown.edge->state == EdgeState::kFailed;
  row.SetValue("LEVEL", failed ? "fail" : "pass");
  row.SetValue("STATE", failed ? "failed" : "good");
  if (contradictions.suspects.contains(shown.edge->id)) row.ShowSection("SUSPECT");
  if (contradictions.alternatives.contains(shown.edge->id)) row.ShowSection("ALTERNATIVE");
}

void FillRow(Dictionary& row, const ReportInput& input, const ShownEdge& shown, const Contradictions& contradictions) {
  const Edge& edge = *shown.edge;
  Dictionary* name = row.AddSectionDictionary(shown.detailed ? "LINK" : "PLAIN");
  name->SetValue("ANCHOR", shown.anchor);
  name->SetValue("FROM", edge.frame_a.str());
  name->SetValue("TO", edge.frame_b.str());
  FillState(row, shown, contradictions);
  row.SetValue("METHOD", edge.method);
  row.SetValue("CAPTURES", CapturesText(edge));
  row.SetValue("CAPTURES_KEY", edge.captures.empty() ? "" : std::to_string(UsedCount(edge)));
  if (edge.state == EdgeState::kGood) return FillGood(row, input, shown);
  ShowValue(row, "FAILED", "WHY", edge.diagnoses.empty() ? "no reason was given" : edge.diagnoses.front().what);
}

}  // namespace

void FillEdges(Dictionary& page, const ReportInput& input, const std::vector<ShownEdge>& edges) {
  const Contradictions contradictions = ContradictionsOf(input.revision.solution.suspects);
  for (std::size_t i = 0; i < std::min(edges.size(), kEdgeRowsMax); ++i)
    FillRow(*page.AddSectionDictionary("EDGE"), input, edges[i], contradictions);
  if (edges.size() > kEdgeRowsMax) ShowValue(page, "MORE_EDGES", "COUNT", std::to_string(edges.size() - kEdgeRowsMax));
  if (const std::string& why_not = input.revision.solution.influences.why_not; !why_not.empty())
    ShowValue(page, "NO_EDGE_INFLUENCE", "TEXT", why_not);
  if (input.revision.solution.dof <= 0)
    ShowValue(page, "UNCHECKED", "TEXT", "Without a loop every residual is zero by construction and checks nothing.");
}

}  // namespace rigcal::report
