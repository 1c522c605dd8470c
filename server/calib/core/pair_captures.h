// Of a session with very many captures, those that one pair uses. A pair is a start, a check and a fallback for the
// joint refinement, which uses all of them: what a pair costs must not grow with the session.
#pragma once

#include <set>
#include <vector>

#include "server/base/ids.h"
#include "server/model/edge.h"

namespace rigcal::calib {

constexpr std::size_t kPairCapturesMax = 120;  // of the session, the same for all its pairs
constexpr std::size_t kSeenByBothMin = 60;     // a pair that has fewer of them uses more of its own, up to these

struct PairCaptures {
  std::set<CaptureId> used, left_out;  // of `session`
};

// Spread over the session in the order in which captures were taken, one of each of kPairCapturesMax stretches, at a place
// in it that does not repeat from stretch to stretch; a session that is not told, or has no more captures, is used whole.
[[nodiscard]] PairCaptures ChooseCaptures(const std::vector<CaptureId>& session, const std::set<CaptureId>& seen_by_both);

// Tells each of the pair's own captures that was left out, with the reason.
void AddLeftOut(const PairCaptures& chosen, const std::set<CaptureId>& of_pair, Edge& edge);

// The edge of the captures chosen; where that is none, or leaves a direction open, the edge of all. `drop(problem, left_out)`
// takes captures out of a problem; `of_pair` are those that it has files of.
template <typename Problem, typename Drop, typename Estimate>
Edge EstimateOfChosen(const Problem& problem, const std::set<CaptureId>& of_pair, const std::set<CaptureId>& seen_by_both,
                      const Drop& drop, const Estimate& estimate) {
  const PairCaptures chosen = ChooseCaptures(problem.session_captures, seen_by_both);
  if (chosen.left_out.empty()) return estimate(problem);
  Problem fewer = problem;
  drop(fewer, chosen.left_out);
  Edge edge = estimate(fewer);
  if (edge.state != EdgeState::kGood || edge.uncertainty.rank < 6) return estimate(problem);
  AddLeftOut(chosen, of_pair, edge);
  return edge;
}

// Of a problem with a list of `captures`.
template <typename Problem>
std::set<CaptureId> CapturesOf(const Problem& problem) {
  std::set<CaptureId> captures;
  for (const auto& capture : problem.captures) captures.insert(capture.capture);
  return captures;
}
template <typename Problem>
void DropCaptures(Problem& problem, const std::set<CaptureId>& left_out) {
  std::erase_if(problem.captures, [&](const auto& capture) { return left_out.contains(capture.capture); });
}

}  // namespace rigcal::calib
