#include "server/detect/markers/marker_layout.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>

#include "server/detect/pictures/plane_map.h"

namespace rigcal::detect {
namespace {

// Agreement of two markers: the place of one as told by the other, in pitches. A layout of the other colour is a whole
// pitch off; telling from far away is less exact.
constexpr double kCredibleRatio = 0.4;  // of two equal boards in one picture each has half of the markers
constexpr double kReach = 3.3, kTolerance = 0.2, kToleranceGrowth = 0.1;

BoardQuad SquareAt(const Eigen::Vector2d& top_left, double side_m) {
  return {top_left, top_left + Eigen::Vector2d(side_m, 0), top_left + Eigen::Vector2d(side_m, side_m),
          top_left + Eigen::Vector2d(0, side_m)};
}

template <typename Quad>
std::vector<Eigen::Vector2d> AsList(const Quad& quad) {
  return {quad.begin(), quad.end()};
}

Eigen::Vector2d CentreOf(const BoardQuad& quad) { return (quad[0] + quad[2]) / 2; }

std::vector<PlacedMarker> AsPrinted(const MarkerLayout& layout, const std::vector<SeenMarker>& seen, int turn) {
  std::vector<PlacedMarker> markers;
  for (const SeenMarker& marker : seen) {
    if (marker.place < 0 || static_cast<std::size_t>(marker.place) >= layout.quads.size()) continue;
    PlacedMarker placed{marker.place, layout.quads[static_cast<std::size_t>(marker.place)], {}};
    for (std::size_t i = 0; i < 4; ++i)
      placed.corners_px[(i + static_cast<std::size_t>(turn)) % 4] = marker.corners_px[i];
    markers.push_back(placed);
  }
  return markers;
}

// Is `other` where `map`, that of a neighbour `distance` pitches away, says?
bool Tells(const PlaneMap& map, const PlacedMarker& other, double pitch_m, double distance) {
  const double side_m = (other.board_m[2] - other.board_m[0]).norm();
  const double pitch_px = (other.corners_px[2] - other.corners_px[0]).norm() / side_m * pitch_m;
  double error_px = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto told = map.Pixel(other.board_m[i]);
    if (!told) return false;
    error_px += (*told - other.corners_px[i]).norm() / 4;
  }
  return error_px < (kTolerance + kToleranceGrowth * distance) * pitch_px;
}

// Joins the sets of markers that agree.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t Root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Unite(std::size_t a, std::size_t b) {
    a = Root(a), b = Root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

Sets Agreeing(const std::vector<PlacedMarker>& markers, double pitch_m, std::vector<int>& friends) {
  std::vector<std::optional<PlaneMap>> maps;
  for (const PlacedMarker& marker : markers)
    maps.push_back(PlaneMap::Fit(AsList(marker.board_m), AsList(marker.corners_px)));
  Sets sets(markers.size());
  for (std::size_t a = 0; a < markers.size(); ++a)
    for (std::size_t b = a + 1; b < markers.size(); ++b) {
      const double distance = (CentreOf(markers[a].board_m) - CentreOf(markers[b].board_m)).norm() / pitch_m;
      if (markers[a].place == markers[b].place || distance > kReach || !maps[a] || !maps[b]) continue;
      if (!Tells(*maps[a], markers[b], pitch_m, distance) && !Tells(*maps[b], markers[a], pitch_m, distance)) continue;
      sets.Unite(a, b);
      ++friends[a], ++friends[b];
    }
  return sets;
}

}  // namespace

bool HasMarker(const Target& target, bool legacy, int col, int row) {
  const bool first_is_white = legacy && (target.rows + 1) % 2 == 0;
  return (col + row) % 2 == (first_is_white ? 0 : 1);
}

MarkerLayout CharucoLayout(const Target& target, bool legacy) {
  MarkerLayout layout{target.square_m, {}};
  const double margin_m = (target.square_m - target.marker_m) / 2;
  for (int row = 0; row <= target.rows; ++row)
    for (int col = 0; col <= target.cols; ++col) {
      if (!HasMarker(target, legacy, col, row)) continue;
      const Eigen::Vector2d corner = Eigen::Vector2d(col - 1, row - 1) * target.square_m;
      layout.quads.push_back(SquareAt(corner.array() + margin_m, target.marker_m));
    }
  return layout;
}

MarkerLayout GridLayout(const Target& target) {
  MarkerLayout layout{target.square_m * (1 + target.spacing_ratio), {}};
  const std::vector<Eigen::Vector3d> points = TargetPoints(target);
  for (std::size_t i = 0; i + 3 < points.size(); i += 4)
    layout.quads.push_back(
        {points[i].head<2>(), points[i + 1].head<2>(), points[i + 2].head<2>(), points[i + 3].head<2>()});
  return layout;
}

std::vector<PlacedMarker> Placed(const MarkerLayout& layout, const std::vector<SeenMarker>& seen, int turn) {
  std::vector<PlacedMarker> markers = AsPrinted(layout, seen, turn);
  if (layout.quads.size() == 1) return markers.size() == 1 ? markers : std::vector<PlacedMarker>();
  std::vector<int> friends(markers.size(), 0);
  Sets sets = Agreeing(markers, layout.pitch_m, friends);
  std::map<std::size_t, std::map<int, std::size_t>> members;  // set: place: which of the markers
  for (std::size_t i = 0; i < markers.size(); ++i) {
    auto [known, added] = members[sets.Root(i)].emplace(markers[i].place, i);
    if (!added && friends[i] > friends[known->second]) known->second = i;
  }
  const auto largest = std::max_element(members.begin(), members.end(),
                                        [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  std::vector<PlacedMarker> placed;
  if (largest == members.end() || largest->second.size() < 2) return placed;
  for (const auto& [place, index] : largest->second) placed.push_back(markers[index]);
  return placed;
}

bool Credible(std::size_t placed, std::size_t seen, std::size_t needed) {
  return placed >= needed && static_cast<double>(placed) >= kCredibleRatio * static_cast<double>(seen);
}

}  // namespace rigcal::detect
