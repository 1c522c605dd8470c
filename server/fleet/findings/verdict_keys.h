// By which lists of robots count what a verdict says where no root cause is behind it.
#pragma once

#include <string>
#include <vector>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// Keys beside those of causes (server/model/cause.h), each once, worst first: "moved right", "lens_changed left",
// "wrong_intrinsics left",
// "disagree left right", "open_loop", "measured_in_part body", "few_captures", "uncertain top", "apart right",
// "unchecked", "hardly_checked".
// `cause_keys`: of the same revision's causes; where there are any, only sensors that were moved are told beside them.
// `others`: as the verdict was judged by (KnownBetween). At most kVerdictKeysMax.
[[nodiscard]] std::vector<std::string> KeysOfVerdict(const Verdict& verdict, const std::vector<Edge>& edges,
                                                     const GraphSolution& solution, const Policy& policy,
                                                     const std::vector<SessionEstimate>& estimates,
                                                     const std::vector<std::string>& cause_keys,
                                                     const OtherPaths& others = {});
inline constexpr std::size_t kVerdictKeysMax = 16;

}  // namespace rigcal::fleet
