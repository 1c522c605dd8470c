#include "server/detect/checkerboard/grid_prediction.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigcal::detect {
namespace {

constexpr std::array<GridPlace, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

struct Prediction {
  Eigen::Vector2f sum_px = Eigen::Vector2f::Zero();
  float count = 0;
  void Add(const Eigen::Vector2f& at_px) { sum_px += at_px, count += 1; }
};

}  // namespace

GridPlace Stepped(const GridPlace& from, std::size_t way, int times) {
  return {from.first + times * kSteps[way % 4].first, from.second + times * kSteps[way % 4].second};
}

const GridNode* At(const SaddleGrid& grid, const GridPlace& place) {
  const auto found = grid.find(place);
  return found == grid.end() ? nullptr : &found->second;
}

std::optional<Eigen::Vector2f> Predicted(const SaddleGrid& grid, const GridPlace& place) {
  Prediction between, beyond;
  for (std::size_t way = 0; way < 4; ++way) {
    const GridNode *a = At(grid, Stepped(place, way)), *b = At(grid, Stepped(place, way, 2));
    const GridNode* c = At(grid, Stepped(place, way, 3));
    const GridNode* opposite = At(grid, Stepped(place, way + 2));
    const GridNode *side = At(grid, Stepped(place, way + 1)), *corner = At(grid, Stepped(Stepped(place, way), way + 1));
    if (a && opposite) between.Add((a->saddle.at_px + opposite->saddle.at_px) / 2);
    if (a && side && corner) beyond.Add(a->saddle.at_px + side->saddle.at_px - corner->saddle.at_px);
    if (!a || !b) continue;
    const Eigen::Vector2f step = a->saddle.at_px - b->saddle.at_px;
    float shrink = 1;  // of the steps from corner to corner, by perspective
    if (c) shrink = std::clamp(step.norm() / (b->saddle.at_px - c->saddle.at_px).norm(), 0.7f, 1.4f);
    beyond.Add(a->saddle.at_px + shrink * step);
  }
  if (between.count > 0) return between.sum_px / between.count;
  if (beyond.count > 0) return beyond.sum_px / beyond.count;
  return std::nullopt;
}

float Spacing_px(const SaddleGrid& grid, const GridPlace& place, const Eigen::Vector2f& at_px) {
  float nearest = HUGE_VALF;
  for (std::size_t way = 0; way < 4; ++way)
    if (const GridNode* node = At(grid, Stepped(place, way)))
      nearest = std::min(nearest, (node->saddle.at_px - at_px).norm());
  return nearest;
}

}  // namespace rigcal::detect
