// The clouds of one capture made ready for registration: maps and points of every level of NDT, pieces of surface.
#pragma once

#include <array>

#include "server/calib/lidar_lidar/ndt_fit.h"
#include "server/calib/lidar_lidar/surface_polish.h"

namespace rigcal::calib {

constexpr std::size_t kNdtLevels = 3;  // voxels of 4, 2 and 1 times the finest

struct LidarClouds {
  std::array<NdtMap, kNdtLevels> maps;  // the coarsest first
  std::array<std::vector<NdtPoint>, kNdtLevels> points;
  NdtMap surfaces;  // of the map's finest voxels
  NdtMap surfaces_moving;
  SurfaceCells cells, cells_moving;  // for the polish; empty without
};

// Voxel of the finest level for clouds of this reach: 1 m on a road, 0.5 m in a room, 0.25 m in a cupboard.
[[nodiscard]] double FinestVoxel_m(const std::vector<Eigen::Vector3f>& points_m);
[[nodiscard]] LidarClouds CloudsOf(const std::vector<Eigen::Vector3f>& map_m,
                                   const std::vector<Eigen::Vector3f>& moving_m, double voxel_m, bool with_cells);

}  // namespace rigcal::calib
