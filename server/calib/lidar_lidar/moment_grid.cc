#include "server/calib/lidar_lidar/moment_grid.h"

#include <bit>
#include <cmath>

namespace rigcal::calib {

Eigen::Vector3i CellOf(CellKey key) {
  constexpr CellKey kMask = (1 << 21) - 1;
  constexpr int kOffset = 1 << 20;
  return {static_cast<int>(key >> 42) - kOffset, static_cast<int>((key >> 21) & kMask) - kOffset,
          static_cast<int>(key & kMask) - kOffset};
}

CellIndex::CellIndex(std::size_t expected) { Grow(std::bit_ceil(2 * expected + 16)); }

void CellIndex::Grow(std::size_t slots) {
  entries_.assign(slots, {});
  mask_ = slots - 1;
  shift_ = 64 - std::countr_zero(slots);
  for (std::size_t number = 0; number < keys_.size(); ++number) {
    std::size_t slot = SlotOf(keys_[number]);
    while (entries_[slot].number >= 0) slot = (slot + 1) & mask_;
    entries_[slot] = {keys_[number], static_cast<std::int32_t>(number)};
  }
}

std::uint32_t CellIndex::Add(CellKey key) {
  std::size_t slot = SlotOf(key);
  for (; entries_[slot].number >= 0; slot = (slot + 1) & mask_)
    if (entries_[slot].key == key) return static_cast<std::uint32_t>(entries_[slot].number);
  const auto number = static_cast<std::uint32_t>(keys_.size());
  entries_[slot] = {key, static_cast<std::int32_t>(number)};
  keys_.push_back(key);
  if (2 * keys_.size() > entries_.size()) Grow(2 * entries_.size());
  return number;
}

void Moments::Add(const Eigen::Vector3d& p) {
  count += 1;
  sum += p;
  products[0] += p.x() * p.x();
  products[1] += p.x() * p.y();
  products[2] += p.x() * p.z();
  products[3] += p.y() * p.y();
  products[4] += p.y() * p.z();
  products[5] += p.z() * p.z();
}

void Moments::Add(const Moments& other) {
  count += other.count;
  sum += other.sum;
  products += other.products;
}

Eigen::Matrix3d Moments::Covariance() const {
  const Eigen::Vector3d mean = Mean();
  Eigen::Matrix3d second;
  second << products[0], products[1], products[2], products[1], products[3], products[4], products[2], products[4],
      products[5];
  return (second - count * mean * mean.transpose()) / (count - 1);
}

MomentGrid MomentGrid::Coarser() const {
  MomentGrid coarse{2 * cell_m, CellIndex(cells.size() / 3), {}};
  coarse.cells.reserve(cells.size() / 2);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Eigen::Vector3i cell = CellOf(index.keys()[i]);
    // An arithmetic shift is the floor of the half.
    const std::uint32_t number = coarse.index.Add(CellKeyOf(cell.x() >> 1, cell.y() >> 1, cell.z() >> 1));
    if (number == coarse.cells.size()) coarse.cells.emplace_back();
    coarse.cells[number].Add(cells[i]);
  }
  return coarse;
}

MomentGrid GridOf(const std::vector<Eigen::Vector3f>& points_m, double cell_m) {
  MomentGrid grid{cell_m, CellIndex(points_m.size() / 4), {}};
  grid.cells.reserve(points_m.size() / 2);
  const double per_m = 1 / cell_m;
  for (const Eigen::Vector3f& point : points_m) {
    const Eigen::Vector3d p = point.cast<double>(), scaled = p * per_m;
    if (!(scaled.cwiseAbs().maxCoeff() < kCellsMax - 2)) continue;
    const std::uint32_t number =
        grid.index.Add(CellKeyOf(static_cast<int>(std::floor(scaled.x())), static_cast<int>(std::floor(scaled.y())),
                                 static_cast<int>(std::floor(scaled.z()))));
    if (number == grid.cells.size()) grid.cells.emplace_back();
    grid.cells[number].Add(p);
  }
  return grid;
}

}  // namespace rigcal::calib
