// Edges of sessions that say too little to be held against better ones: they see a part of the six directions, or were
// found where two clouds hardly overlap. What errs alike in all captures of such a pair is in no sigma of it.
#pragma once

#include <string>

#include "server/model/edges/edge.h"

namespace rigcal {

constexpr double kWeakOverlap_ratio = 0.4;  // less: see lidar_lidar's figure of that name
// Sigma along what is known worst over that along what is known best, a turn of 1 rad taken for 1 m; more: weak.
constexpr double kWeakSigmasRatio = 300.0;

// Of a good edge: "it sees 5 of 6 directions"; empty where it is not weak. Edges that were pushed as finished results
// never are: who pushed one wants it to count.
[[nodiscard]] std::string WhyWeak(const Edge& edge);

// Figure of a merged edge of sessions' weak edges.
inline constexpr const char* kMergedWeak = "merged_weak";

}  // namespace rigcal
