// Which saddle points are next to each other on a checkerboard.
#pragma once

#include <array>
#include <vector>

#include "server/detect/checkerboard/saddle_points.h"

namespace rigcal::detect {

constexpr int kNoNeighbour = -1;

// By way: the index of the saddle point at the other end of that edge.
using Neighbours = std::array<int, 4>;

// Where the edge that leaves `from` towards `to` is dark and light on the right sides all along, and `to` answers with
// the other kind of way.
[[nodiscard]] bool EdgeBetween(const GreyLevel& level, const Saddle& from, std::size_t way, const Saddle& to);
// The way of `saddle` that points the most along `direction`.
[[nodiscard]] std::size_t WayAlong(const Saddle& saddle, const Eigen::Vector2f& direction);

// For each saddle point the nearest ones that EdgeBetween() agrees to, up to `reach_px` away; mutual ones only.
[[nodiscard]] std::vector<Neighbours> NeighboursOf(const GreyLevel& level, const std::vector<Saddle>& saddles,
                                                   float reach_px);

}  // namespace rigcal::detect
