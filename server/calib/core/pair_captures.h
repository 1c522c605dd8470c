// Of a session with very many captures, those that one pair uses. A pair is a start, a check and a fallback for the
// joint refinement, which uses all of them: what a pair costs must not grow with the session.
#pragma once

#include <set>
#include <vector>

#include "server/base/ids.h"
#include "server/model/edge.h"

namespace rigcal::calib {

constexpr std::size_t kPairCapturesMax = 120;  // of the session, the same for all its pairs
constexpr std::size_t kSeenByBothMin = 30;     // a pair that has fewer of them uses more of its own, up to these

struct PairCaptures {
  std::set<CaptureId> used, left_out;  // of `session`
};

// Evenly spread over the session in the order in which captures were taken; a session that is not told, or has no more
// than kPairCapturesMax captures, is used whole.
[[nodiscard]] PairCaptures ChooseCaptures(const std::vector<CaptureId>& session, const std::set<CaptureId>& seen_by_both);

// Tells each capture that was left out, with the reason; captures_total counts them.
void AddLeftOut(const PairCaptures& chosen, Edge& edge);

// The edge of the captures chosen; `drop(problem, left_out)` takes the others out of a problem.
template <typename Problem, typename Drop, typename Estimate>
Edge EstimateOfChosen(const Problem& problem, const std::set<CaptureId>& seen_by_both, const Drop& drop,
                      const Estimate& estimate) {
  const PairCaptures chosen = ChooseCaptures(problem.session_captures, seen_by_both);
  if (chosen.left_out.empty()) return estimate(problem);
  Problem fewer = problem;
  drop(fewer, chosen.left_out);
  Edge edge = estimate(fewer);
  AddLeftOut(chosen, edge);
  return edge;
}

// Of a problem with a list of `captures`.
template <typename Problem>
void DropCaptures(Problem& problem, const std::set<CaptureId>& left_out) {
  std::erase_if(problem.captures, [&](const auto& capture) { return left_out.contains(capture.capture); });
}

}  // namespace rigcal::calib
