#include "client/sim/rig/printed_pattern.h"

#include <algorithm>
#include <cmath>

namespace rigcal::sim {

Result<PrintedPattern> PrintedPattern::Of(const Target& target) {
  RIGCAL_ASSIGN(const print::Pattern drawn, print::DrawPattern(target));
  const Eigen::Array2d size_m(drawn.width_m, drawn.height_m);
  Eigen::Array2d corner_m = -size_m / 2;
  if (target.plate_offset_m) corner_m -= target.plate_offset_m->array();
  PrintedPattern pattern;
  pattern.low_ = corner_m.cast<float>();
  pattern.bin_m_ = (size_m / kBins).cast<float>();
  pattern.bins_.resize(kBins * kBins);
  for (const print::Rectangle& one : drawn.black) {
    const Eigen::Array2d low_m = corner_m + Eigen::Array2d(one.x_m, one.y_m);
    pattern.Add(low_m, low_m + Eigen::Array2d(one.width_m, one.height_m), false);
  }
  for (const print::Disc& one : drawn.discs) {
    const Eigen::Array2d centre_m = corner_m + Eigen::Array2d(one.x_m, one.y_m);
    pattern.Add(centre_m - one.diameter_m / 2, centre_m + one.diameter_m / 2, true);
  }
  return pattern;
}

void PrintedPattern::Add(const Eigen::Array2d& low_m, const Eigen::Array2d& high_m, bool is_disc) {
  const auto idx = static_cast<int>(shapes_.size());
  shapes_.push_back({low_m.cast<float>(), high_m.cast<float>(), is_disc});
  const Eigen::Array2i first = BinOf(shapes_.back().low), last = BinOf(shapes_.back().high);
  for (int row = first.y(); row <= last.y(); ++row)
    for (int col = first.x(); col <= last.x(); ++col) bins_[static_cast<std::size_t>(row * kBins + col)].push_back(idx);
}

Eigen::Array2i PrintedPattern::BinOf(const Eigen::Array2f& place) const {
  return ((place - low_) / bin_m_).max(0.0f).min(kBins - 1.0f).cast<int>();
}

// A shape of several bins is seen in the first one that it shares with the box.
template <typename See>
void PrintedPattern::Near(const Eigen::Array2f& low, const Eigen::Array2f& high, const See& see) const {
  const Eigen::Array2i first = BinOf(low), last = BinOf(high);
  for (int row = first.y(); row <= last.y(); ++row)
    for (int col = first.x(); col <= last.x(); ++col)
      for (const int idx : bins_[static_cast<std::size_t>(row * kBins + col)]) {
        const Shape& shape = shapes_[static_cast<std::size_t>(idx)];
        if ((BinOf(shape.low).max(first) == Eigen::Array2i(col, row)).all()) see(shape);
      }
}

bool PrintedPattern::IsBlack(const Eigen::Vector2d& ab_m) const {
  const Eigen::Array2f place = ab_m.cast<float>().array();
  bool is_black = false;
  Near(place, place, [&](const Shape& shape) {
    if ((place < shape.low).any() || (place > shape.high).any()) return;
    const Eigen::Array2f from_middle = place - (shape.low + shape.high) / 2;
    const float radius = (shape.high.x() - shape.low.x()) / 2;
    is_black |= !shape.is_disc || from_middle.matrix().norm() <= radius;
  });
  return is_black;
}

// Of a rectangle exactly, side by side; of a disc as if its rim were straight within the point spread.
float PrintedPattern::Black(const Eigen::Array2f& ab_m, const Eigen::Array2f& blur_m, const SoftEdge& edge) const {
  const Eigen::Array2f reach = SoftEdge::kReach * blur_m;
  float black = 0;
  Near(ab_m - reach, ab_m + reach, [&](const Shape& shape) {
    if (shape.is_disc) {
      const Eigen::Vector2f from_middle = ab_m - (shape.low + shape.high) / 2;
      const float radius = (shape.high.x() - shape.low.x()) / 2, distance = std::max(from_middle.norm(), 1e-9f);
      const float blur = (from_middle.array() / distance * blur_m).matrix().norm();
      black += edge((radius - distance) / std::max(blur, 1e-9f));
      return;
    }
    const Eigen::Array2f from = (ab_m - shape.low) / blur_m, to = (ab_m - shape.high) / blur_m;
    black += (edge(from.x()) - edge(to.x())) * (edge(from.y()) - edge(to.y()));
  });
  return std::clamp(black, 0.0f, 1.0f);
}

}  // namespace rigcal::sim
