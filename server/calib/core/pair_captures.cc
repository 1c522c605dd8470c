#include "server/calib/core/pair_captures.h"

#include <algorithm>
#include <string>

#include "server/calib/core/capture_blocks.h"

namespace rigcal::calib {
namespace {

using InOrder = std::set<CaptureId, TakenBefore>;

// `count` of them, or all.
template <typename Each>
void ForEvenlySpread(const InOrder& captures, std::size_t count, const Each& each) {
  count = std::min(count, captures.size());
  std::size_t idx = 0;
  for (const CaptureId& capture : captures) {
    if ((idx + 1) * count / captures.size() > idx * count / captures.size()) each(capture);
    ++idx;
  }
}

}  // namespace

PairCaptures ChooseCaptures(const std::vector<CaptureId>& session, const std::set<CaptureId>& seen_by_both) {
  const InOrder all(session.begin(), session.end());
  PairCaptures chosen;
  const auto use = [&](const CaptureId& capture) { chosen.used.insert(capture); };
  ForEvenlySpread(all, all.size() <= kPairCapturesMax ? all.size() : kPairCapturesMax, use);
  InOrder more;
  for (const CaptureId& capture : seen_by_both)
    if (all.contains(capture) && !chosen.used.contains(capture)) more.insert(capture);
  const std::size_t used_by_both = seen_by_both.size() - more.size();
  if (used_by_both < kSeenByBothMin) ForEvenlySpread(more, kSeenByBothMin - used_by_both, use);
  for (const CaptureId& capture : all)
    if (!chosen.used.contains(capture)) chosen.left_out.insert(capture);
  return chosen;
}

void AddLeftOut(const PairCaptures& chosen, Edge& edge) {
  const std::string why = "left to the joint refinement: the pair uses " + std::to_string(chosen.used.size()) +
                          " of the session's captures, evenly spread";
  for (const CaptureId& capture : chosen.left_out) edge.captures.push_back({capture, 0.0, false, why});
  std::stable_sort(edge.captures.begin(), edge.captures.end(),
                   [](const CaptureResidual& a, const CaptureResidual& b) { return a.capture < b.capture; });
  edge.figures["captures_total"] = static_cast<double>(chosen.used.size() + chosen.left_out.size());
}

}  // namespace rigcal::calib
