// Pairs of two lidars that say too little to be held against better edges: their clouds hardly overlap, or tell a part
// of the six directions only. What registration errs by is the same in all captures of such a place, and in no sigma.
// Pairs of other methods that see a part know that part as well as they say.
#pragma once

#include <string>

#include "server/model/edges/edge.h"

namespace rigcal {

constexpr double kWeakOverlap_ratio = 0.4;  // of the moving cloud; less: weak

// Of a good edge of a session: "it sees 5 of 6 directions"; empty where it is not weak. What was pushed as a finished
// result never is: who pushed it wants it to count.
[[nodiscard]] std::string WhyWeak(const Edge& edge);

// Figure of a merged edge of weak ones.
inline constexpr const char* kMergedWeak = "merged_weak";

}  // namespace rigcal
