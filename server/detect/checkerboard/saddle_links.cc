#include "server/detect/checkerboard/saddle_links.h"

#include <algorithm>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr float kAlongMin = 0.95f;      // cosine between an edge at its corner and the line to the next corner
constexpr float kOtherAlongMin = 0.8f;  // between the edges across at two corners next to each other
constexpr float kSideRatio = 0.12f, kSideMin_px = 1.5f;  // how far from an edge its sides are looked at
constexpr float kStepRatio = 0.3f;                       // least contrast over the edge, of the corners'
constexpr int kCell_px = 8, kAskedMax = 96;

// Saddle points by cell of the picture.
class Cells {
 public:
  Cells(const GreyLevel& level, const std::vector<Saddle>& saddles)
      : cols_(level.width_px / kCell_px + 1), rows_(level.height_px / kCell_px + 1) {
    starts_.assign(static_cast<std::size_t>(cols_ * rows_ + 1), 0);
    for (const Saddle& saddle : saddles) ++starts_[Of(saddle) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    members_.resize(saddles.size());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t i = 0; i < saddles.size(); ++i) members_[next[Of(saddles[i])]++] = static_cast<int>(i);
  }
  // Visits the members of the cells `ring` cells away (as a king moves) from that of `saddle`.
  template <typename Visit>
  void VisitRing(const Saddle& saddle, int ring, const Visit& visit) const {
    const int col = static_cast<int>(saddle.at_px.x()) / kCell_px, row = static_cast<int>(saddle.at_px.y()) / kCell_px;
    for (int r = std::max(0, row - ring); r <= std::min(rows_ - 1, row + ring); ++r) {
      const bool whole = std::abs(r - row) == ring;
      for (int c = col - ring; c <= col + ring; c += whole ? 1 : std::max(1, 2 * ring)) {
        if (c < 0 || c >= cols_) continue;
        const auto cell = static_cast<std::size_t>(r * cols_ + c);
        for (std::size_t i = starts_[cell]; i < starts_[cell + 1]; ++i) visit(members_[i]);
      }
    }
  }

 private:
  [[nodiscard]] std::size_t Of(const Saddle& saddle) const {
    const int col = std::clamp(static_cast<int>(saddle.at_px.x()) / kCell_px, 0, cols_ - 1);
    const int row = std::clamp(static_cast<int>(saddle.at_px.y()) / kCell_px, 0, rows_ - 1);
    return static_cast<std::size_t>(row * cols_ + col);
  }
  int cols_, rows_;
  std::vector<std::size_t> starts_;
  std::vector<int> members_;
};

float Cross(const Eigen::Vector2f& u, const Eigen::Vector2f& v) { return u.x() * v.y() - u.y() * v.x(); }

bool LightAndDark(const GreyLevel& level, const Saddle& from, std::size_t way, const Saddle& to) {
  const Eigen::Vector2f step = to.at_px - from.at_px;
  const float length = step.norm(), side = std::max(kSideMin_px, kSideRatio * length);
  const Eigen::Vector2f clockwise = Eigen::Vector2f(-step.y(), step.x()) / length * side;
  const float wanted = kStepRatio * std::min(from.contrast, to.contrast) * (way % 2 == 0 ? 1.0f : -1.0f);
  for (const float part : {0.3f, 0.5f, 0.7f}) {
    const Eigen::Vector2f middle = from.at_px + part * step;
    const float rise = level.Between(middle + clockwise) - level.Between(middle - clockwise);
    if (wanted > 0 ? rise < wanted : rise > wanted) return false;
  }
  return true;
}

struct Nearest {
  int saddle = kNoNeighbour;
  float squared_px = HUGE_VALF;
};

void Ask(const GreyLevel& level, const std::vector<Saddle>& saddles, int from, int to, float reach_px,
         std::array<Nearest, 4>& nearest) {
  if (from == to) return;
  const Saddle &a = saddles[static_cast<std::size_t>(from)], &b = saddles[static_cast<std::size_t>(to)];
  const Eigen::Vector2f step = b.at_px - a.at_px;
  const float squared_px = step.squaredNorm();
  if (squared_px > reach_px * reach_px || squared_px < 9) return;
  const std::size_t way = WayAlong(a, step);
  Nearest& known = nearest[way];
  if (squared_px > known.squared_px || (squared_px == known.squared_px && to > known.saddle)) return;
  if (EdgeBetween(level, a, way, b)) known = {to, squared_px};
}

Neighbours NearestOf(const GreyLevel& level, const std::vector<Saddle>& saddles, const Cells& cells, int from,
                     float reach_px) {
  std::array<Nearest, 4> nearest;
  const int rings = static_cast<int>(std::ceil(reach_px / kCell_px));
  int asked = 0;
  for (int ring = 0; ring <= rings && asked < kAskedMax; ++ring) {
    cells.VisitRing(saddles[static_cast<std::size_t>(from)], ring, [&](int to) {
      Ask(level, saddles, from, to, reach_px, nearest);
      ++asked;
    });
    const float sure_px = static_cast<float>(ring * kCell_px);  // nothing nearer can be in further rings
    if (std::all_of(nearest.begin(), nearest.end(),
                    [&](const Nearest& one) { return one.squared_px <= sure_px * sure_px; }))
      break;
  }
  return {nearest[0].saddle, nearest[1].saddle, nearest[2].saddle, nearest[3].saddle};
}

}  // namespace

std::size_t WayAlong(const Saddle& saddle, const Eigen::Vector2f& direction) {
  const float first = saddle.ways[0].dot(direction), second = saddle.ways[1].dot(direction);
  if (std::abs(first) >= std::abs(second)) return first >= 0 ? 0 : 2;
  return second >= 0 ? 1 : 3;
}

bool EdgeBetween(const GreyLevel& level, const Saddle& from, std::size_t way, const Saddle& to) {
  const Eigen::Vector2f direction = (to.at_px - from.at_px).normalized();
  if (from.ways[way].dot(direction) < kAlongMin) return false;
  const std::size_t answer = (way + 1) % 2;  // the other kind
  if (std::abs(to.ways[answer].dot(direction)) < kAlongMin) return false;
  if (std::abs(from.ways[(way + 1) % 4].dot(to.ways[answer + 1])) < kOtherAlongMin) return false;
  if (std::abs(Cross(from.ways[(way + 1) % 4], direction)) < 0.3f) return false;
  return LightAndDark(level, from, way, to);
}

std::vector<Neighbours> NeighboursOf(const GreyLevel& level, const std::vector<Saddle>& saddles, float reach_px) {
  const Cells cells(level, saddles);
  std::vector<Neighbours> nearest;
  nearest.reserve(saddles.size());
  for (std::size_t i = 0; i < saddles.size(); ++i)
    nearest.push_back(NearestOf(level, saddles, cells, static_cast<int>(i), reach_px));
  std::vector<Neighbours> mutual = nearest;
  for (std::size_t i = 0; i < saddles.size(); ++i)
    for (std::size_t way = 0; way < 4; ++way) {
      const int other = nearest[i][way];
      if (other == kNoNeighbour) continue;
      const auto& back = nearest[static_cast<std::size_t>(other)];
      const Eigen::Vector2f step = saddles[i].at_px - saddles[static_cast<std::size_t>(other)].at_px;
      if (back[WayAlong(saddles[static_cast<std::size_t>(other)], step)] != static_cast<int>(i))
        mutual[i][way] = kNoNeighbour;
    }
  return mutual;
}

}  // namespace rigcal::detect
