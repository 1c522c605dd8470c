#include "server/detect/circles/circle_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "server/detect/circles/circle_edge.h"
#include "server/detect/circles/circle_lattice.h"
#include "server/detect/circles/circle_perspective.h"

namespace rigcal::detect {
namespace {

using Places = std::vector<CirclePlace>;  // by the index of the target's points

// Of the lattice of nearest neighbours: an asymmetric grid's lies askew, along its diagonals.
Places PlacesOf(const Target& target) {
  Places places;
  for (int row = 0; row < target.rows; ++row)
    for (int col = 0; col < target.cols; ++col) {
      const int across = 2 * col + row % 2;
      if (target.kind == TargetKind::kAsymmetricCircleGrid)
        places.emplace_back((across + row) / 2, (row - across) / 2);
      else
        places.emplace_back(col, row);
    }
  return places;
}

// A quarter turn, clockwise.
Places Turned(Places places) {
  for (auto& [col, row] : places) std::tie(col, row) = CirclePlace(-row, col);
  return places;
}

CirclePlace Corner(const Places& places) {
  CirclePlace least = places.front();
  for (const auto& [col, row] : places) least = {std::min(least.first, col), std::min(least.second, row)};
  return least;
}

// The circles in the order of `places`, if the lattice is of these and no others.
std::optional<std::vector<Ellipse>> InOrder(const CircleLattice& lattice, const Places& places) {
  Places seen;
  for (const auto& [place, ellipse] : lattice) seen.push_back(place);
  const CirclePlace here = Corner(seen), there = Corner(places);
  std::vector<Ellipse> ordered;
  for (const auto& [col, row] : places) {
    const auto at = lattice.find({col - there.first + here.first, row - there.second + here.second});
    if (at == lattice.end()) return std::nullopt;
    ordered.push_back(at->second);
  }
  return ordered;
}

// In the turn that starts closest to the picture's top left, of those that fit.
std::optional<std::vector<Ellipse>> BoardIn(const CircleLattice& lattice, const Target& target) {
  Places places = PlacesOf(target);
  if (lattice.size() != places.size()) return std::nullopt;
  std::optional<std::vector<Ellipse>> best;
  for (int turn = 0; turn < 4; ++turn, places = Turned(std::move(places)))
    if (auto ordered = InOrder(lattice, places))
      if (!best || ordered->front().centre_px.sum() < best->front().centre_px.sum()) best = std::move(ordered);
  return best;
}

double NearestRatio(const Target& target) {
  return (target.kind == TargetKind::kAsymmetricCircleGrid ? std::sqrt(2.0) : 1.0) * target.square_m /
         (target.diameter_m / 2);
}

std::string SizeOf(const CircleLattice& lattice) {
  CirclePlace low = lattice.begin()->first, high = low;
  for (const auto& [place, ellipse] : lattice) {
    low = {std::min(low.first, place.first), std::min(low.second, place.second)};
    high = {std::max(high.first, place.first), std::max(high.second, place.second)};
  }
  return std::to_string(high.first - low.first + 1) + " x " + std::to_string(high.second - low.second + 1);
}

std::string NoGrid(const Target& target) {
  return "no grid of " + std::to_string(target.cols) + " x " + std::to_string(target.rows) + " circles in the picture";
}

std::string WhyNot(const Target& target, const std::vector<CircleLattice>& lattices) {
  const std::string board = NoGrid(target);
  if (lattices.empty() || lattices.front().size() < 4)
    return board +
           "; no circles that lie as on it: show the whole board, sharp and evenly lit, and check spacing_m "
           "and diameter_m";
  const std::size_t count = lattices.front().size(), wanted = static_cast<std::size_t>(target.cols * target.rows);
  if (count == wanted) return board + "; as many circles hang together, but not in its rows and columns: check circles";
  return board + "; " + std::to_string(count) + " circles hang together" +
         (target.kind == TargetKind::kCircleGrid ? " in " + SizeOf(lattices.front()) : "") + ", and it has " +
         std::to_string(wanted) +
         (count < wanted ? ": show all of it, nothing in front of it, or check circles" : ": check circles");
}

// Nothing where one of them is not a whole ellipse.
std::optional<std::vector<Eigen::Vector2d>> CentroidsOf(const GreyImage& image, const std::vector<Ellipse>& circles,
                                                        double nearest_ratio) {
  std::vector<Eigen::Vector2d> centroids_px;
  for (const Ellipse& circle : circles) {
    const auto sharp = Sharpened(image, circle, nearest_ratio - 2);
    if (!sharp) return std::nullopt;
    centroids_px.push_back(sharp->centre_px);
  }
  return centroids_px;
}

}  // namespace

void FindCircleGrid(const GreyImage& image, const Target& target, BoardView& view) {
  const double nearest_ratio = NearestRatio(target);
  const std::vector<CircleLattice> lattices = LatticesOf(FindEllipses(image), nearest_ratio);
  std::vector<std::vector<Eigen::Vector2d>> boards_px;
  view.why_not = WhyNot(target, lattices);
  for (const CircleLattice& lattice : lattices)
    if (const auto circles = BoardIn(lattice, target)) {
      view.why_not = NoGrid(target) +
                     "; one of them is not round: show the whole board, sharp, evenly lit and nothing "
                     "in front of it";
      if (auto centroids_px = CentroidsOf(image, *circles, nearest_ratio)) boards_px.push_back(*centroids_px);
    }
  if (boards_px.size() > 1)
    view.why_not = NoGrid(target) + " that is the only one: show one board at a time, or boards of other counts";
  if (boards_px.size() != 1) return;
  std::vector<Eigen::Vector2d> board_m;
  for (const Eigen::Vector3d& point : TargetPoints(target)) board_m.emplace_back(point.head<2>());
  view.why_not.clear();
  view.found = true;
  view.corners_px =
      CentresFrom(board_m, target.diameter_m / 2, boards_px.front(), Eigen::Vector2d(image.width_px, image.height_px));
  view.corner_idx.resize(view.corners_px.size());
  std::iota(view.corner_idx.begin(), view.corner_idx.end(), 0);
}

}  // namespace rigcal::detect
