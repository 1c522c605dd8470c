// The points of a cloud gathered in cubic cells: how many, their sum and the sum of their products. Cells of twice the
// size are sums of eight, so that one pass over the points serves every level of a search from coarse to fine.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "server/base/process/parallel_for.h"

namespace rigcal::calib {

// Of a cell: floor(p / cell_m) on each axis, packed into 64 bits.
using CellKey = std::uint64_t;
constexpr double kCellsMax = 1 << 20;  // from the origin, each way, per axis

// Of cell (x, y, z), each within kCellsMax of the origin's, which is not checked; and back.
[[nodiscard]] inline CellKey CellKeyOf(int x, int y, int z) {
  constexpr int kOffset = 1 << 20;
  return (static_cast<CellKey>(x + kOffset) << 42) | (static_cast<CellKey>(y + kOffset) << 21) |
         static_cast<CellKey>(z + kOffset);
}
[[nodiscard]] Eigen::Vector3i CellOf(CellKey key);

// From keys to 0, 1, 2, ... in the order of their first appearance; open addressing.
class CellIndex {
 public:
  // Room for so many keys before it grows.
  explicit CellIndex(std::size_t expected = 0);
  // The number of this key, a new one if it is new.
  std::uint32_t Add(CellKey key);
  [[nodiscard]] int Find(CellKey key) const {
    for (std::size_t slot = SlotOf(key);; slot = (slot + 1) & mask_) {
      const Entry& entry = entries_[slot];
      if (entry.number < 0 || entry.key == key) return entry.number;
    }
  }
  [[nodiscard]] const std::vector<CellKey>& keys() const { return keys_; }  // in the order of their numbers

 private:
  struct Entry {
    CellKey key = 0;
    std::int32_t number = -1;
  };
  [[nodiscard]] std::size_t SlotOf(CellKey key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> shift_) & mask_;
  }
  void Grow(std::size_t slots);

  std::vector<Entry> entries_;
  std::vector<CellKey> keys_;
  std::size_t mask_ = 0;
  int shift_ = 32;
};

// `body(number)` of every cell of the index within `reach` of this one.
template <typename Body>
void ForCellsAround(const CellIndex& index, const Eigen::Vector3i& cell, int reach, const Body& body) {
  for (int dx = -reach; dx <= reach; ++dx)
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dz = -reach; dz <= reach; ++dz)
        if (const int number = index.Find(CellKeyOf(cell.x() + dx, cell.y() + dy, cell.z() + dz)); number >= 0)
          body(static_cast<std::size_t>(number));
}

// Of chunks of every term, in their order: the same on any number of threads.
template <typename Sums, typename Term, typename SizeOf, typename SumsOf>
std::vector<Sums> SumsOfChunks(const std::vector<Term>& terms, std::size_t chunk, const SizeOf& size_of,
                               const SumsOf& sums_of) {
  struct Chunk {
    const Term* term;
    std::size_t begin, end;
  };
  std::vector<Chunk> chunks;
  for (const Term& term : terms)
    for (std::size_t begin = 0; begin < size_of(term); begin += chunk)
      chunks.push_back({&term, begin, std::min(begin + chunk, size_of(term))});
  std::vector<Sums> sums(chunks.size());
  ParallelFor(chunks.size(),
              [&](std::size_t i) { sums[i] = sums_of(*chunks[i].term, chunks[i].begin, chunks[i].end); });
  return sums;
}

struct Moments {
  double count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 6, 1> products = Eigen::Matrix<double, 6, 1>::Zero();  // xx xy xz yy yz zz

  // A point, or all of another cell's, in the same frame. The mean of nothing is no number.
  void Add(const Eigen::Vector3d& p);
  void Add(const Moments& other);
  [[nodiscard]] Eigen::Vector3d Mean() const { return sum / count; }
  [[nodiscard]] Eigen::Matrix3d Covariance() const;  // count >= 2
};

struct MomentGrid {
  double cell_m = 1;
  CellIndex index;
  std::vector<Moments> cells;  // by the index's numbers

  // Cells of twice the size.
  [[nodiscard]] MomentGrid Coarser() const;
};

// Deterministic: sums run in the order of the points. Points farther than kCellsMax cells are left out.
[[nodiscard]] MomentGrid GridOf(const std::vector<Eigen::Vector3f>& points_m, double cell_m);

}  // namespace rigcal::calib
