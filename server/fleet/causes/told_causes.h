// Root causes as a revision keeps them, and the keys by which lists of many robots count them.
#pragma once

#include <string>
#include <vector>

#include "server/fleet/causes/root_causes.h"
#include "server/model/cause.h"

namespace rigcal::fleet {

// In the same order.
[[nodiscard]] std::vector<Cause> ToldCauses(const std::vector<RootCause>& causes);

// Of these, and of each failed pair that none of them explains; each once, causes first. At most kCauseKeysMax: where
// there are more, the last is kMoreCausesKey.
[[nodiscard]] std::vector<std::string> CauseKeysOf(const std::vector<RootCause>& causes, const std::vector<Edge>& edges,
                                                   const SessionTimes& captured_at);
inline constexpr std::size_t kCauseKeysMax = 64;

}  // namespace rigcal::fleet
