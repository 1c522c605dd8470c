#include "server/detect/circles/circle_lattice.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>

namespace rigcal::detect {
namespace {

// Blur and few pixels make an ellipse too large or too small by so much; from one circle to the next perspective does.
constexpr double kPitchLow = 0.6, kPitchHigh = 1.45;
constexpr double kSizeLow = 0.6, kSizeHigh = 1.7;
// Of a neighbour against the nearest: the next ones on a diagonal are 1.41 times as far, 45 degrees off.
constexpr double kFarther = 1.33, kAskewCosine = 0.86;

using Index = std::size_t;
constexpr Index kNone = static_cast<Index>(-1);
using FourWays = std::array<Index, 4>;  // right, down, left, up as turned in the picture; kNone: nobody

// Ellipses by place.
class Buckets {
 public:
  explicit Buckets(const std::vector<Ellipse>& ellipses) {
    for (Index i = 0; i < ellipses.size(); ++i) cells_[CellOf(ellipses[i].centre_px)].push_back(i);
  }
  template <typename Do>
  void Around(const Eigen::Vector2d& at_px, double reach_px, const Do& take) const {
    const auto low = CellOf(at_px.array() - reach_px), high = CellOf(at_px.array() + reach_px);
    for (int y = low.first; y <= high.first; ++y)
      for (auto at = cells_.lower_bound({y, low.second}); at != cells_.end() && at->first <= std::pair(y, high.second);
           ++at)
        for (const Index i : at->second) take(i);
  }

 private:
  static constexpr double kCell_px = 32;
  // Row and column of cells.
  [[nodiscard]] static std::pair<int, int> CellOf(const Eigen::Vector2d& at_px) {
    return {static_cast<int>(std::floor(at_px.y() / kCell_px)), static_cast<int>(std::floor(at_px.x() / kCell_px))};
  }
  std::map<std::pair<int, int>, std::vector<Index>> cells_;
};

bool IsAlike(const Ellipse& ellipse, const Ellipse& other) {
  if (ellipse.is_dark != other.is_dark) return false;
  const double ratio = std::sqrt(other.axes_px.determinant() / ellipse.axes_px.determinant());
  return ratio > kSizeLow && ratio < kSizeHigh;
}

struct Neighbour {
  Index idx = kNone;
  Eigen::Vector2d away = Eigen::Vector2d::Zero();  // as seen from the front, in radii
};

std::vector<Neighbour> NearOnes(const std::vector<Ellipse>& ellipses, const Buckets& buckets, Index of,
                                double pitch_ratio) {
  const Ellipse& ellipse = ellipses[of];
  std::vector<Neighbour> near;
  buckets.Around(ellipse.centre_px, kPitchHigh * pitch_ratio * ellipse.Major_px(), [&](Index i) {
    if (i == of || !IsAlike(ellipse, ellipses[i])) return;
    const Eigen::Vector2d away = ellipse.Whitened(ellipses[i].centre_px);
    if (away.norm() > kPitchLow * pitch_ratio && away.norm() < kPitchHigh * pitch_ratio) near.push_back({i, away});
  });
  std::sort(near.begin(), near.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::pair(a.away.squaredNorm(), a.idx) < std::pair(b.away.squaredNorm(), b.idx);
  });
  return near;
}

// The nearest sets the directions.
FourWays WaysOf(const std::vector<Neighbour>& near) {
  FourWays ways;
  ways.fill(kNone);
  if (near.empty()) return ways;
  Eigen::Vector2d way = near.front().away.normalized();
  const double far = kFarther * near.front().away.norm();
  for (Index& slot : ways) {
    for (const Neighbour& one : near)
      if (slot == kNone && one.away.norm() <= far && one.away.dot(way) > kAskewCosine * one.away.norm()) slot = one.idx;
    way = Eigen::Vector2d(-way.y(), way.x());
  }
  return ways;
}

std::optional<Index> SlotOf(const FourWays& ways, Index idx) {
  const auto at = std::find(ways.begin(), ways.end(), idx);
  if (at == ways.end()) return std::nullopt;
  return static_cast<Index>(at - ways.begin());
}

// Places are told from circle to circle; a circle that would have two is a contradiction.
class Walk {
 public:
  Walk(const std::vector<Ellipse>& ellipses, const std::vector<FourWays>& ways) : ellipses_(ellipses), ways_(ways) {}

  // Of all that hangs together with `first`; empty where it contradicts itself.
  CircleLattice From(Index first, std::vector<bool>& visited) {
    bool holds = true;
    std::map<Index, Stand> stands = {{first, {}}};
    std::deque<Index> open = {first};
    visited[first] = true;
    for (; !open.empty(); open.pop_front())
      for (Index slot = 0; slot < 4; ++slot) {
        const Index next = ways_[open.front()][slot];
        const auto back = next == kNone ? std::nullopt : SlotOf(ways_[next], open.front());
        if (!back) continue;
        const Stand stand = Stepped(stands.at(open.front()), slot, *back);
        const auto [at, is_new] = stands.emplace(next, stand);
        holds = holds && at->second == stand;
        if (is_new) open.push_back(next);
        visited[next] = true;
      }
    CircleLattice lattice;
    for (const auto& [idx, stand] : stands) holds &= lattice.emplace(stand.place, ellipses_[idx]).second;
    return holds ? lattice : CircleLattice();
  }

 private:
  // Its slot i looks along way (i + turn) % 4 of the lattice.
  struct Stand {
    CirclePlace place = {0, 0};
    Index turn = 0;
    bool operator==(const Stand&) const = default;
  };
  static Stand Stepped(const Stand& from, Index slot, Index back) {
    constexpr std::array<CirclePlace, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    const Index way = (slot + from.turn) % 4;
    return {{from.place.first + kSteps[way].first, from.place.second + kSteps[way].second}, (way + 6 - back) % 4};
  }
  const std::vector<Ellipse>& ellipses_;
  const std::vector<FourWays>& ways_;
};

}  // namespace

std::vector<CircleLattice> LatticesOf(const std::vector<Ellipse>& ellipses, double pitch_ratio) {
  const Buckets buckets(ellipses);
  std::vector<FourWays> ways;
  for (Index i = 0; i < ellipses.size(); ++i) ways.push_back(WaysOf(NearOnes(ellipses, buckets, i, pitch_ratio)));
  std::vector<bool> visited(ellipses.size(), false);
  std::vector<CircleLattice> lattices;
  Walk walk(ellipses, ways);
  for (Index i = 0; i < ellipses.size(); ++i)
    if (!visited[i])
      if (CircleLattice lattice = walk.From(i, visited); !lattice.empty()) lattices.push_back(std::move(lattice));
  std::stable_sort(lattices.begin(), lattices.end(),
                   [](const CircleLattice& a, const CircleLattice& b) { return a.size() > b.size(); });
  return lattices;
}

}  // namespace rigcal::detect
