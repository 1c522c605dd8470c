// The clouds of one capture made ready for registration (maps and points of every level of NDT, pieces of surface), and
// their surfaces paired by a pose: what checks it, says which directions it is known in, and how well.
#pragma once

#include <array>
#include <vector>

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

// A point of the moving cloud (the mean of a cell) and the flat voxel of the map that it lies on.
struct SurfacePair {
  Eigen::Vector3d normal_map;  // towards the map's sensor
  Eigen::Vector3d mean_moving_m;
  double distance_m = 0;  // of the point from the surface, along the normal
  double normal_variance_rad2 = 0;
};
// Flat voxels of both clouds on one surface: normals in their own frames, each towards its own sensor.
struct NormalPair {
  Eigen::Vector3d normal_map, normal_moving, mean_moving_m;
};

struct SurfacePairs {
  std::vector<SurfacePair> pairs;
  std::vector<NormalPair> normals;
  std::size_t near = 0;  // points beside or on a flat voxel's surface, whether they agree with it or not
};

// At this pose: points within 0.15 of a voxel of the nearest flat voxel's surface, and flat voxels of both clouds whose
// normals agree to 20 degrees.
[[nodiscard]] SurfacePairs PairsOf(const LidarClouds& clouds, const Se3& T_map_moving);

// Orthonormal directions of T * Exp(xi) that the pairs say nothing about (a corridor's axis, a plane's two shifts and
// turn). A direction counts as known if the distances respond to it at least five times as much as they would if all
// surfaces were parallel to it and their normals noisy.
[[nodiscard]] Directions Unknown(const std::vector<SurfacePairs>& captures, const Se3& T_map_moving);

// Omega of the pose from the scatter of the distances: voxels near each other share their errors, so blocks of them
// count, not points. Zero along `unknown`. `blocks`: how many there were.
struct PairInformation {
  Matrix6d Omega = Matrix6d::Zero();
  std::size_t blocks = 0;
};
// At the pose. Omega is zero with fewer blocks than two more than there are known directions.
[[nodiscard]] PairInformation InformationOf(const std::vector<SurfacePairs>& captures, const Se3& T_map_moving,
                                            const Directions& unknown, double voxel_m);

}  // namespace rigcal::calib
