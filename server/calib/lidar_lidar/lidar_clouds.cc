#include "server/calib/lidar_lidar/lidar_clouds.h"

#include <algorithm>
#include <cmath>

#include "server/base/parallel_for.h"

namespace rigcal::calib {
namespace {

constexpr double kReachPerVoxel =
    8;  // the finest voxel is this part of the distance that a quarter of the points exceed
constexpr double kVoxelMin_m = 0.25, kVoxelMax_m = 1.0;
constexpr int kCellHalvings = 2;  // points are means of cells of a quarter of the voxel

// Grids of a cloud from a quarter of the finest voxel to the coarsest.
std::vector<MomentGrid> Pyramid(const std::vector<Eigen::Vector3f>& points_m, double voxel_m) {
  std::vector<MomentGrid> grids{GridOf(points_m, voxel_m / (1 << kCellHalvings))};
  while (grids.size() < kNdtLevels + kCellHalvings) grids.push_back(grids.back().Coarser());
  return grids;
}

}  // namespace

double FinestVoxel_m(const std::vector<Eigen::Vector3f>& points_m) {
  if (points_m.empty()) return kVoxelMax_m;
  std::vector<float> ranges_m;
  for (const Eigen::Vector3f& p : points_m) ranges_m.push_back(p.norm());
  const auto far = ranges_m.begin() + static_cast<std::ptrdiff_t>(ranges_m.size() * 3 / 4);
  std::nth_element(ranges_m.begin(), far, ranges_m.end());
  const double voxel_m = std::exp2(std::round(std::log2(std::max<double>(*far, 0.1) / kReachPerVoxel)));
  return std::clamp(voxel_m, kVoxelMin_m, kVoxelMax_m);
}

LidarClouds CloudsOf(const std::vector<Eigen::Vector3f>& map_m, const std::vector<Eigen::Vector3f>& moving_m,
                     double voxel_m, bool with_cells) {
  std::array<std::vector<MomentGrid>, 2> grids;
  ParallelFor(2, [&](std::size_t i) { grids[i] = Pyramid(i == 0 ? map_m : moving_m, voxel_m); });
  LidarClouds clouds;
  ParallelFor(kNdtLevels + 2, [&](std::size_t i) {
    if (i < kNdtLevels) {
      const std::size_t halvings = kNdtLevels - 1 - i;
      clouds.maps[i] = NdtMapOf(grids[0][halvings + kCellHalvings], NdtKind::kDistributions);
      clouds.points[i] = NdtPointsOf(grids[1][halvings]);
    } else {
      (i == kNdtLevels ? clouds.surfaces : clouds.surfaces_moving) =
          NdtMapOf(grids[i - kNdtLevels][kCellHalvings], NdtKind::kSurfaces);
    }
  });
  if (!with_cells) return clouds;
  clouds.cells = SurfaceCellsOf(grids[0][0]);
  clouds.cells_moving = SurfaceCellsOf(grids[1][0]);
  return clouds;
}

}  // namespace rigcal::calib
