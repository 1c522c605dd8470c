#include "server/calib/lidar_lidar/ndt_map.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kThinnestRatio = 0.01;  // of the largest variance: no Gaussian is thinner (Magnusson)
constexpr double kFlatRatio = 0.06;      // of the middle variance: a surface is thinner than this,
constexpr double kLineRatio = 0.04;      // and its middle variance more than this part of the largest: one row is none
constexpr double kSurfaceMin_m = 0.01;   // no surface is known better than this

void FillDistribution(const Eigen::Vector3d& variances, const Eigen::Matrix3d& axes, NdtVoxel& voxel) {
  const Eigen::Vector3d clamped = variances.cwiseMax(std::max(kThinnestRatio * variances[2], 1e-6));
  voxel.information = axes * clamped.cwiseInverse().asDiagonal() * axes.transpose();
}

void FillSurface(NdtVoxel& voxel) {
  if (!voxel.flat) return;
  const double variance = voxel.across_m * voxel.across_m + kSurfaceMin_m * kSurfaceMin_m;
  voxel.information = voxel.normal * voxel.normal.transpose() / variance;
}

NdtVoxel VoxelOf(const Moments& moments, NdtKind kind) {
  NdtVoxel voxel;
  voxel.count = moments.count;
  voxel.mean_m = moments.Mean();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread;
  spread.computeDirect(moments.Covariance());
  const Eigen::Vector3d variances = spread.eigenvalues().cwiseMax(0.0);
  voxel.normal = spread.eigenvectors().col(0);
  if (voxel.normal.dot(voxel.mean_m) > 0) voxel.normal = -voxel.normal;
  voxel.across_m = std::sqrt(variances[0]);
  voxel.flat = variances[0] < kFlatRatio * variances[1] && variances[1] > kLineRatio * variances[2];
  if (voxel.flat) voxel.normal_variance_rad2 = variances[0] / (variances[1] * voxel.count);
  if (kind == NdtKind::kDistributions)
    FillDistribution(variances, spread.eigenvectors(), voxel);
  else
    FillSurface(voxel);
  return voxel;
}

}  // namespace

NdtMap NdtMapOf(const MomentGrid& grid, NdtKind kind) {
  NdtMap map{grid.cell_m, kind, CellIndex(grid.cells.size() / 2), {}};
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    if (grid.cells[i].count < kNdtPointsMin) continue;
    NdtVoxel voxel = VoxelOf(grid.cells[i], kind);
    if (kind == NdtKind::kSurfaces && !voxel.flat) continue;
    map.index.Add(grid.index.keys()[i]);
    map.voxels.push_back(std::move(voxel));
  }
  return map;
}

}  // namespace rigcal::calib
