// The drawing of a sensor graph. Up to kRingMax sensors: a ring, with names up to kNamedMax. More: a map of the solved
// positions, seen along the axis of the reference frame in which the graph is thinnest; edges and sensors are then one
// path each, so that the page stays small.
#pragma once

#include <string>
#include <vector>

#include "server/report/edges/edge_order.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

inline constexpr std::size_t kNamedMax = 60;
inline constexpr std::size_t kRingMax = 400;
inline constexpr std::size_t kTracesMax = 20'000;  // dots, and lines, on a map

// Fills graph.tpl's dictionary; returns the sentence that explains the drawing. Past edges are left out.
std::string FillGraph(Dictionary& svg, const formats::RevisionInput& revision, std::vector<ShownEdge> edges);

// The two kinds.
std::string FillRing(Dictionary& svg, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges);
std::string FillMap(Dictionary& svg, const formats::RevisionInput& revision, const std::vector<ShownEdge>& edges);

inline constexpr const char* kGoodStroke = "#5478a8";
inline constexpr const char* kFailedStroke = "#b3263a";
inline constexpr const char* kKnownFill = "#1f56a5";
inline constexpr const char* kUnknownFill = "#98a2b3";

}  // namespace rigcal::report
