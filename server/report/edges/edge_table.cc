#include <algorithm>
#include <cmath>

#include "server/model/edges/past.h"
#include "server/model/edges/weak_edge.h"
#include "server/report/edges/edge_fit.h"
#include "server/report/edges/tables.h"
#include "server/report/frame/retired_section.h"
#include "server/report/text/edge_axes.h"
#include "server/report/text/edge_state.h"
#include "server/report/text/figure_words.h"
#include "server/report/text/influence.h"
#include "server/report/text/sigmas.h"
#include "server/report/text/text.h"

namespace rigcal::report {
namespace {

// Of three axes, each with the decimals of its sigma.
std::string ThreeNumbers(const Vector6d& e, const Uncertainty& uncertainty, int first_axis, double scale) {
  std::string text;
  for (int axis = first_axis; axis < first_axis + 3; ++axis) {
    const AxisSigma sigma = SigmaOf(uncertainty, axis);
    text += (text.empty() ? "" : " / ") + (sigma.known && sigma.value > 0.0
                                               ? AsCertainAs(e(axis) * scale, sigma.value * scale)
                                               : Significant(e(axis) * scale, 2));
  }
  return text;
}

// Left out beside better edges (graph/solve/weak_edges.h); one outside the reference's part of the graph is not solved.
bool IsWeakAside(const Edge& edge, const GraphSolution& solution) {
  return !WhyWeak(edge).empty() && std::none_of(solution.residuals.begin(), solution.residuals.end(),
                                                [&](const EdgeResidual& residual) { return residual.edge == edge.id; });
}

// Where nothing checks an edge, its residual is zero by construction: no number to show.
void FillFit(Dictionary& good, const ReportInput& input, const ShownEdge& shown, const UncheckedParts& unchecked) {
  const std::string part = unchecked.Of(shown.edge->id);
  if (!shown.residual)
    return ShowValue(good, "NO_FIT", "WHY",
                     IsWeakAside(*shown.edge, input.revision.solution) ? "too weak: takes no part" : "not solved");
  if (unchecked.whole.contains(shown.edge->id)) return ShowValue(good, "NO_FIT", "WHY", part);
  Dictionary* fit = good.AddSectionDictionary("FIT");
  const Vector6d& e = shown.residual->e;
  const Uncertainty& uncertainty = shown.edge->uncertainty;
  fit->SetValue("E_MM", ThreeNumbers(e, uncertainty, tangent::kTranslation, kMmPerMetre));
  fit->SetValue("E_MM_KEY", Significant(e.head<3>().norm() * kMmPerMetre, 6));
  fit->SetValue("E_DEG", ThreeNumbers(e, uncertainty, tangent::kRotation, kDegPerRad));
  fit->SetValue("E_SIGMA", Fixed(shown.in_sigmas, 2));
  fit->SetValue("CLASS", FitClass(shown, unchecked));
  if (!part.empty()) ShowValue(*fit, "IN_PART", "WHAT", part);
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

// Only what is not the rule is said.
void FillSource(Dictionary& good, UncertaintySource source) {
  if (source == UncertaintySource::kJackknife) return;
  ShowValue(good, "SOURCE", "TEXT",
            source == UncertaintySource::kModel   ? "model alone"
            : source == UncertaintySource::kGiven ? "as given"
                                                  : "assumed");
}

void FillGood(Dictionary& row, const ReportInput& input, const ShownEdge& shown, const UncheckedParts& unchecked) {
  Dictionary* good = row.AddSectionDictionary("GOOD");
  const Edge& edge = *shown.edge;
  FillFit(*good, input, shown, unchecked);
  FillTest(*good, input, edge.id);
  good->SetValue("S_MM", ThreeSigmas(edge.uncertainty, tangent::kTranslation));
  good->SetValue("S_MM_KEY", SigmaKey(edge.uncertainty, tangent::kTranslation));
  good->SetValue("S_DEG", ThreeSigmas(edge.uncertainty, tangent::kRotation));
  FillSource(*good, edge.uncertainty.source);
  FillInfluenceCell(*good, input, edge);
  FillWithout(*good, input.revision.solution.influences, edge.id);
}

std::ptrdiff_t UsedCount(const Edge& edge) {
  return std::count_if(edge.captures.begin(), edge.captures.end(), [](const auto& one) { return one.used; });
}

std::string CapturesText(const Edge& edge) {
  if (edge.captures.empty()) return "";
  const auto used = static_cast<std::size_t>(UsedCount(edge)), all = edge.captures.size();
  return std::to_string(used) + (used == all ? "" : " of " + std::to_string(all));
}

// One word: what contradicts others is not called good as well.
void FillState(Dictionary& row, const ShownEdge& shown, const Contradictions& contradictions) {
  const bool suspect = contradictions.suspects.contains(shown.edge->id);
  const bool one_of_several = contradictions.alternatives.contains(shown.edge->id);
  row.SetValue("LEVEL", suspect ? "fail" : one_of_several ? "warn" : StateLevel(*shown.edge));
  row.SetValue("STATE", suspect ? "contradicts" : one_of_several ? "doubtful" : StateWord(*shown.edge));
}

struct Judged {
  Contradictions contradictions;
  UncheckedParts unchecked;
};

void FillRow(Dictionary& row, const ReportInput& input, const ShownEdge& shown, const Judged& judged) {
  const Edge& edge = *shown.edge;
  Dictionary* name = row.AddSectionDictionary(shown.detailed ? "LINK" : shown.detailed_in != 0 ? "EARLIER" : "PLAIN");
  name->SetValue("REVISION", std::to_string(shown.detailed_in));
  name->SetValue("ANCHOR", shown.anchor);
  name->SetValue("FROM", edge.frame_a.str());
  name->SetValue("TO", edge.frame_b.str());
  FillState(row, shown, judged.contradictions);
  row.SetValue("METHOD", MethodText(edge));
  row.SetValue("CAPTURES", CapturesText(edge));
  row.SetValue("CAPTURES_KEY", edge.captures.empty() ? "" : std::to_string(UsedCount(edge)));
  if (edge.state == EdgeState::kGood) return FillGood(row, input, shown, judged.unchecked);
  Dictionary* failed = row.AddSectionDictionary("FAILED");
  failed->SetValue("WHY", edge.diagnoses.empty() ? "no reason was given" : edge.diagnoses.front().what);
  if (IsPast(edge)) ShowValue(*failed, "CURE", "TEXT", edge.diagnoses.front().cure);
}

// Of few edges, one with a section of its own has it there. Of many the first rows are what one looks for: failed ones,
// then the worst fits.
void FillWayOut(Dictionary& row, const ShownEdge& shown, bool many) {
  if ((many || !shown.detailed) && HasWayOut(*shown.edge)) FillRetire(row, RetireCommand(shown.edge->id));
}

void FillGroupRow(Dictionary& row, const EdgeGroup& group) {
  Dictionary* name = row.AddSectionDictionary(group.anchor.empty() ? "PLAIN" : "LINK");
  name->SetValue("ANCHOR", group.anchor);
  name->SetValue("COUNT", Count(group.pairs, "pair", "pairs"));
  row.SetValue("WHY", group.cause->why);
  FillPairs(row, group.edges);
}

}  // namespace

void FillEdges(Dictionary& page, const ReportInput& input, const EdgesByCause& edges) {
  const Judged judged{ContradictionsOf(input.revision.solution.suspects), UncheckedPartsOf(input.revision)};
  for (const EdgeGroup& group : edges.groups) FillGroupRow(*page.AddSectionDictionary("EDGE_GROUP"), group);
  const std::size_t alone = edges.others.size();
  const bool many = input.revision.edges.size() > kWaysOutMax;
  for (std::size_t i = 0; i < std::min(alone, kEdgeRowsMax); ++i) {
    Dictionary* row = page.AddSectionDictionary("EDGE");
    FillRow(*row, input, *edges.others[i], judged);
    if (i < kWaysOutMax) FillWayOut(*row, *edges.others[i], many);
  }
  if (many) ShowValue(page, "OTHER_IDS", "ROBOT", input.revision.robot.str());
  if (alone > kEdgeRowsMax) ShowValue(page, "MORE_EDGES", "COUNT", std::to_string(alone - kEdgeRowsMax));
  if (const std::string& why_not = input.revision.solution.influences.why_not; !why_not.empty())
    ShowValue(page, "NO_EDGE_INFLUENCE", "TEXT", why_not);
  if (input.revision.solution.dof <= 0)
    ShowValue(page, "UNCHECKED", "TEXT", "Without a loop every residual is zero by construction and checks nothing.");
}

}  // namespace rigcal::report
