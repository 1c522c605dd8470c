#include "server/calib/lidar_lidar/surface_cells.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/parallel_for.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kMeans = 10, kMeansMin = 5;  // that make a normal
constexpr int kBucketCells = 4;                    // a normal's means lie within so many cells

template <typename Body>
void ForCellsAround(const CellIndex& index, const Eigen::Vector3i& cell, int reach, const Body& body) {
  for (int dx = -reach; dx <= reach; ++dx)
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dz = -reach; dz <= reach; ++dz)
        if (const int number = index.Find(CellKeyOf(cell.x() + dx, cell.y() + dy, cell.z() + dz)); number >= 0)
          body(static_cast<std::size_t>(number));
}

struct Near {
  double distance_m2;
  std::size_t number;
  bool operator<(const Near& other) const {
    return distance_m2 != other.distance_m2 ? distance_m2 < other.distance_m2 : number < other.number;
  }
};

// Which cells lie in each cube of kBucketCells^3.
struct Buckets {
  CellIndex index;
  std::vector<std::vector<std::size_t>> cells;
};

Eigen::Vector3i BucketOf(const Eigen::Vector3i& cell) {
  return {cell.x() >> 2, cell.y() >> 2, cell.z() >> 2};  // an arithmetic shift is the floor of the quarter
}

Buckets BucketsOf(const CellIndex& index) {
  static_assert(kBucketCells == 4);
  Buckets buckets{CellIndex(index.keys().size() / 8), {}};
  for (std::size_t number = 0; number < index.keys().size(); ++number) {
    const Eigen::Vector3i at = BucketOf(CellOf(index.keys()[number]));
    const std::uint32_t bucket = buckets.index.Add(CellKeyOf(at.x(), at.y(), at.z()));
    if (bucket == buckets.cells.size()) buckets.cells.emplace_back();
    buckets.cells[bucket].push_back(number);
  }
  return buckets;
}

// The nearest cells, itself included.
std::vector<Near> NearestOf(const SurfaceCells& surface, const Buckets& buckets, std::size_t number) {
  std::vector<Near> near;
  const Eigen::Vector3d at = surface.cells[number].mean_m;
  ForCellsAround(buckets.index, BucketOf(CellOf(surface.index.keys()[number])), 1, [&](std::size_t bucket) {
    for (const std::size_t other : buckets.cells[bucket])
      near.push_back({(surface.cells[other].mean_m - at).squaredNorm(), other});
  });
  if (near.size() > kMeans) {
    std::nth_element(near.begin(), near.begin() + kMeans, near.end());
    near.resize(kMeans);
  }
  std::sort(near.begin(), near.end());  // sums in one order
  return near;
}

void FillNormal(const Buckets& buckets, SurfaceCells& surface, std::size_t number) {
  std::vector<SurfaceCell>& cells = surface.cells;
  const std::vector<Near> near = NearestOf(surface, buckets, number);
  if (near.size() < kMeansMin) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Near& other : near) mean += cells[other.number].mean_m / static_cast<double>(near.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Near& other : near) {
    const Eigen::Vector3d off = cells[other.number].mean_m - mean;
    scatter += off * off.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread;
  spread.computeDirect(scatter);
  cells[number].normal = spread.eigenvectors().col(0);
  cells[number].has_normal = cells[number].normal.allFinite();
}

}  // namespace

const SurfaceCell* SurfaceCells::Nearest(const Eigen::Vector3d& q_m) const {
  const Eigen::Vector3d scaled = q_m / cell_m;
  if (!(scaled.cwiseAbs().maxCoeff() < kCellsMax - 4)) return nullptr;
  const SurfaceCell* nearest = nullptr;
  double best_m2 = std::numeric_limits<double>::infinity();
  ForCellsAround(index, scaled.array().floor().cast<int>(), 2, [&](std::size_t number) {
    const double distance_m2 = (cells[number].mean_m - q_m).squaredNorm();
    if (distance_m2 < best_m2) best_m2 = distance_m2, nearest = &cells[number];
  });
  return nearest;
}

SurfaceCells SurfaceCellsOf(const MomentGrid& grid) {
  SurfaceCells surface{grid.cell_m, grid.index, std::vector<SurfaceCell>(grid.cells.size())};
  for (std::size_t i = 0; i < grid.cells.size(); ++i) surface.cells[i].mean_m = grid.cells[i].Mean();
  const Buckets buckets = BucketsOf(grid.index);
  constexpr std::size_t kChunk = 512;
  ParallelFor((grid.cells.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min((chunk + 1) * kChunk, grid.cells.size());
    for (std::size_t i = chunk * kChunk; i < end; ++i) FillNormal(buckets, surface, i);
  });
  return surface;
}

}  // namespace rigcal::calib
