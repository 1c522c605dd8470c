// The map of NDT: a Gaussian for every occupied voxel of a cloud (Biber & Strasser 2003; Magnusson 2009).
#pragma once

#include "server/calib/lidar_lidar/moment_grid.h"

namespace rigcal::calib {

enum class NdtKind {
  kDistributions,  // the whole Gaussian: wide basin, but pulls along a surface towards the middle of a voxel
  kSurfaces,       // flat voxels only, and only across their surface: what the final pose is made of
};

struct NdtVoxel {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // 1/m^2; zero: nothing to hold a point against
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();      // direction of least spread, towards the sensor
  double across_m = 0;                                    // standard deviation along the normal
  double normal_variance_rad2 = 0;                        // of the normal, from its points' noise
  double count = 0;
  bool flat = false;
};

struct NdtMap {
  double voxel_m = 1;
  NdtKind kind = NdtKind::kDistributions;
  CellIndex index;
  std::vector<NdtVoxel> voxels;  // by the index's numbers; voxels of too few points are not there
};

constexpr double kNdtPointsMin = 6;  // of a voxel that has a Gaussian

[[nodiscard]] NdtMap NdtMapOf(const MomentGrid& grid, NdtKind kind);

}  // namespace rigcal::calib
