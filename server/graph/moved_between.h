// Was a sensor moved between two visits? For each sensor s, the reference too, and each session k after the oldest: what the
// sessions from k on say against those before, d_s = Log(T_before,s^-1 T_after,s) of all sensors that both tell, with the
// covariance S of both sides and the scatter that visits have within the sides. The step that explains it best, its gain
// d^T S^-1 E m over six numbers, is an F where the scatter was estimated; odds are corrected for all looks. What was found
// is taken out of the sessions before, and the next is looked for.
#pragma once

#include "server/graph/session_fusion.h"

namespace rigcal::graph {

// `estimates` newest first. Only sessions that are fused take part, at most the newest kVisitsCompared.
constexpr std::size_t kVisitsCompared = 8;
[[nodiscard]] std::vector<SensorMovedBetween> FindMovesBetween(const FusionInput& input,
                                                               const std::vector<SessionEstimate>& estimates);

}  // namespace rigcal::graph
