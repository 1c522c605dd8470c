#include "server/report/edges/edge_order.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "server/model/edges/past.h"
#include "server/report/edges/edge_fit.h"
#include "server/report/text/edge_state.h"

namespace rigcal::report {
namespace {

// A section costs its heading, too.
std::size_t ItemsOf(const Edge& edge) {
  const auto pictures = static_cast<std::size_t>(std::count_if(
      edge.evidence.begin(), edge.evidence.end(), [](const Evidence& one) { return one.suffix != "fit"; }));
  return 2 + edge.captures.size() + std::min(pictures, kPicturesPerEdgeMax) + edge.diagnoses.size();
}

bool HasDetails(const Edge& edge) {
  return !edge.captures.empty() || !edge.evidence.empty() || !edge.diagnoses.empty() || !edge.figures.empty();
}

double InSigmas(const Edge& edge, const EdgeResidual* residual) {
  if (!residual) return 0.0;
  const double statistic = residual->by_jackknife ? residual->t_squared : residual->weighted;
  const int rank = residual->by_jackknife ? residual->rank : edge.uncertainty.rank;
  return rank > 0 && statistic > 0.0 ? std::sqrt(statistic / rank) : 0.0;
}

int RankOf(const Edge& edge) { return HasFailed(edge) ? 0 : IsPast(edge) ? 2 : 1; }

bool Before(const ShownEdge& left, const ShownEdge& right) {
  const auto key = [](const ShownEdge& shown) {
    return std::make_tuple(RankOf(*shown.edge), -shown.in_sigmas, shown.edge->frame_a, shown.edge->frame_b,
                           shown.edge->id);
  };
  return key(left) < key(right);
}

void ChooseDetailed(std::vector<ShownEdge>& shown) {
  std::size_t items = 0;
  for (ShownEdge& one : shown) {
    if (one.detailed_in != 0 || !HasDetails(*one.edge) || items + ItemsOf(*one.edge) > kDetailItemsMax) continue;
    items += ItemsOf(*one.edge);
    one.detailed = true;
  }
}

}  // namespace

std::set<EdgeId> WorthDetails(const ReportInput& input) {
  const Contradictions contradictions = ContradictionsOf(input.revision.solution.suspects);
  std::set<EdgeId> worth = contradictions.suspects;
  worth.insert(contradictions.alternatives.begin(), contradictions.alternatives.end());
  for (const auto& [edge, test] : input.limits)
    if (test.limit > 0.0 && test.statistic > test.limit) worth.insert(edge);
  for (const Edge& edge : input.revision.edges)
    if (HasFailed(edge)) worth.insert(edge.id);
  return worth;
}

std::vector<ShownEdge> InOrder(const formats::RevisionInput& revision, const std::map<EdgeId, int>& detailed_in) {
  std::unordered_map<EdgeId, const EdgeResidual*> residuals;
  for (const EdgeResidual& residual : revision.solution.residuals)
    if (residual.in_solution) residuals.emplace(residual.edge, &residual);
  std::vector<ShownEdge> shown;
  shown.reserve(revision.edges.size());
  for (const Edge& edge : revision.edges) {
    const auto found = residuals.find(edge.id);
    const EdgeResidual* residual = found == residuals.end() ? nullptr : found->second;
    const auto elsewhere = detailed_in.find(edge.id);
    shown.push_back({&edge, residual, false, InSigmas(edge, residual), "e-" + edge.id.str().substr(0, 16),
                     elsewhere == detailed_in.end() ? 0 : elsewhere->second});
  }
  std::sort(shown.begin(), shown.end(), Before);
  ChooseDetailed(shown);
  return shown;
}

}  // namespace rigcal::report
