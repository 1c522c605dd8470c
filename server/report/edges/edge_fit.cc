#include "server/report/edges/edge_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "server/model/graph/unchecked.h"
#include "server/report/text/sigmas.h"

namespace rigcal::report {
namespace {

// -log of the largest known sigma of the position.
std::optional<double> InformationOf(const Edge& edge) {
  double largest_m = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const AxisSigma sigma = SigmaOf(edge.uncertainty, axis);
    if (!sigma.known) return std::nullopt;
    largest_m = std::max(largest_m, sigma.value);
  }
  if (edge.state != EdgeState::kGood || !(largest_m > 0.0)) return std::nullopt;
  return -std::log(largest_m);
}

}  // namespace

std::string UncheckedParts::Of(const EdgeId& edge) const {
  if (whole.contains(edge)) return "nothing checks it";
  const auto found = in_part.find(edge);
  return found == in_part.end() ? "" : found->second;
}

UncheckedParts UncheckedPartsOf(const formats::RevisionInput& revision) {
  UncheckedParts parts{UncheckedEdges(revision.solution), {}};
  for (const HardlyChecked& one : revision.basis.hardly_checked) parts.in_part.emplace(one.edge, one.what);
  return parts;
}

const char* FitClass(const ShownEdge& shown, const UncheckedParts& unchecked) {
  const EdgeId& edge = shown.edge->id;
  if (shown.edge->state == EdgeState::kFailed) return "failed";
  if (!shown.residual || unchecked.whole.contains(edge)) return "unchecked";
  return unchecked.in_part.contains(edge) && shown.in_sigmas < kOff_sigmas ? "unchecked" : SigmasClass(shown.in_sigmas);
}

Contradictions ContradictionsOf(const Suspects& suspects) {
  Contradictions found;
  for (const SuspectEdge& suspect : suspects.edges) {
    (suspect.alternatives.empty() ? found.suspects : found.alternatives).insert(suspect.edge);
    found.alternatives.insert(suspect.alternatives.begin(), suspect.alternatives.end());
  }
  for (const TwoPoses& two : suspects.two_poses) {
    found.alternatives.insert(two.group_a.begin(), two.group_a.end());
    found.alternatives.insert(two.group_b.begin(), two.group_b.end());
  }
  for (const EdgeId& suspect : found.suspects) found.alternatives.erase(suspect);
  return found;
}

InformationScale::InformationScale(const std::vector<ShownEdge>& edges) {
  bool first = true;
  for (const ShownEdge& shown : edges) {
    const auto information = InformationOf(*shown.edge);
    if (!information) continue;
    least_ = first ? *information : std::min(least_, *information);
    most_ = first ? *information : std::max(most_, *information);
    first = false;
  }
}

double InformationScale::Width_px(const Edge& edge) const {
  constexpr double kThin_px = 1.8, kMiddle_px = 3.2, kThick_px = 6.0, kEven = 0.2;
  const auto information = InformationOf(edge);
  if (!information) return kThin_px;
  if (most_ - least_ < kEven) return kMiddle_px;
  return kThin_px + (kThick_px - kThin_px) * (*information - least_) / (most_ - least_);
}

}  // namespace rigcal::report
