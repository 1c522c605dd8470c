#include "server/calib/lidar_lidar/lidar_clouds.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "server/base/process/parallel_for.h"
#include "server/calib/core/robust.h"
#include "server/math/covariance.h"

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

constexpr double kAlikeCos = 0.94;           // 20 degrees between the normals of a pair
constexpr double kNearVoxels = 0.9;          // along the surface
constexpr double kMatchVoxels = 0.15;        // across it
constexpr double kNormalFloor_rad = 0.0175;  // no normal is better than this
constexpr double kKnownRatio = 25;  // squared: five times; rooms and roads have 75 and more, corridors 10 at most
constexpr double kDistanceFloor_m = 0.003;
constexpr double kBlockVoxels = 2;    // edge of a block that shares its errors
constexpr double kModelFactor = 3.0;  // variance over the blocks' own, from simulated rooms

const NdtVoxel* NearestFlat(const NdtMap& map, const Eigen::Vector3d& q_m) {
  const Eigen::Vector3d scaled = q_m / map.voxel_m;
  if (!(scaled.cwiseAbs().maxCoeff() < kCellsMax - 4)) return nullptr;
  const NdtVoxel* nearest = nullptr;
  double best_m2 = std::numeric_limits<double>::infinity();
  ForCellsAround(map.index, scaled.array().floor().cast<int>(), 1, [&](std::size_t number) {
    const NdtVoxel& voxel = map.voxels[number];
    const double distance_m2 = (voxel.mean_m - q_m).squaredNorm();
    if (distance_m2 < best_m2) best_m2 = distance_m2, nearest = &voxel;
  });
  return nearest;
}

struct OnSurface {
  const NdtVoxel* voxel = nullptr;
  double distance_m = 0;
};

// The flat voxel that a point lies on or beside, if it lies within its surface.
OnSurface NearestSurface(const NdtMap& map, const Eigen::Vector3d& q_m) {
  const NdtVoxel* voxel = NearestFlat(map, q_m);
  if (voxel == nullptr) return {};
  const Eigen::Vector3d off = q_m - voxel->mean_m;
  const double distance_m = voxel->normal.dot(off);
  if ((off - distance_m * voxel->normal).norm() > kNearVoxels * map.voxel_m) return {};
  return {voxel, distance_m};
}

// d distance / d xi for T * Exp(xi), of a surface with this normal in the map's frame.
Vector6d Response(const Eigen::Vector3d& normal_map, const SurfacePair& pair, const Eigen::Matrix3d& R) {
  Vector6d j;
  const Eigen::Vector3d n = R.transpose() * normal_map;
  j << n, pair.mean_moving_m.cross(n);
  return j;
}

// Robust sigma of all distances.
double DistanceSigma_m(const std::vector<SurfacePairs>& captures) {
  std::vector<double> distances_m;
  for (const SurfacePairs& capture : captures)
    for (const SurfacePair& pair : capture.pairs) distances_m.push_back(std::abs(pair.distance_m));
  if (distances_m.empty()) return kDistanceFloor_m;
  return std::max(kDistanceFloor_m, kMadSigma * MedianOf(std::move(distances_m)));
}

struct BlockSums {
  Matrix6d H = Matrix6d::Zero(), M = Matrix6d::Zero();
  std::size_t blocks = 0;
};

void AddCapture(const SurfacePairs& capture, const Eigen::Matrix3d& R, double sigma_m, double block_m,
                BlockSums& sums) {
  std::map<CellKey, Vector6d> gradients;
  for (const SurfacePair& pair : capture.pairs) {
    const double ratio = pair.distance_m / (3 * sigma_m), weight = 1 / std::pow(1 + ratio * ratio, 2);
    const Vector6d j = Response(pair.normal_map, pair, R);
    sums.H += weight * j * j.transpose();
    const Eigen::Vector3i at = (pair.mean_moving_m / block_m).array().floor().cast<int>();
    auto [gradient, is_new] = gradients.try_emplace(CellKeyOf(at.x(), at.y(), at.z()), Vector6d::Zero());
    gradient->second += weight * pair.distance_m * j;
  }
  for (const auto& [key, gradient] : gradients) sums.M += gradient * gradient.transpose();
  sums.blocks += gradients.size();
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

SurfacePairs PairsOf(const LidarClouds& clouds, const Se3& T_map_moving) {
  const double voxel_m = clouds.surfaces.voxel_m;
  SurfacePairs result;
  for (const NdtPoint& point : clouds.points.back()) {
    const OnSurface on = NearestSurface(clouds.surfaces, T_map_moving * point.p_m);
    if (on.voxel == nullptr) continue;
    ++result.near;
    if (std::abs(on.distance_m) <= kMatchVoxels * voxel_m)
      result.pairs.push_back({on.voxel->normal, point.p_m, on.distance_m, on.voxel->normal_variance_rad2});
  }
  for (const NdtVoxel& moving : clouds.surfaces_moving.voxels) {
    const OnSurface on = NearestSurface(clouds.surfaces, T_map_moving * moving.mean_m);
    if (on.voxel == nullptr || std::abs(on.distance_m) > kMatchVoxels * voxel_m) continue;
    if (on.voxel->normal.dot(T_map_moving.R() * moving.normal) < kAlikeCos) continue;
    result.normals.push_back({on.voxel->normal, moving.normal, moving.mean_m});
  }
  return result;
}

Directions Unknown(const std::vector<SurfacePairs>& captures, const Se3& T_map_moving) {
  const Eigen::Matrix3d R = T_map_moving.R();
  Matrix6d H = Matrix6d::Zero(), noise = Matrix6d::Zero();
  std::size_t count = 0;
  for (const SurfacePairs& capture : captures)
    for (const SurfacePair& pair : capture.pairs) {
      const Vector6d j = Response(pair.normal_map, pair, R);
      H += j * j.transpose();
      const double variance = pair.normal_variance_rad2 + kNormalFloor_rad * kNormalFloor_rad;
      for (int axis = 0; axis < 3; ++axis) {  // a normal that errs to all sides
        const Vector6d e = Response(Eigen::Vector3d::Unit(axis), pair, R);
        noise += variance * e * e.transpose();
      }
      ++count;
    }
  if (count < 12) return Matrix6d::Identity();
  Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> against(H, noise);
  Directions unknown(6, 0);
  for (int i = 0; i < 6; ++i)
    if (!(against.eigenvalues()[i] >= kKnownRatio)) {
      unknown.conservativeResize(6, unknown.cols() + 1);
      unknown.col(unknown.cols() - 1) = against.eigenvectors().col(i).normalized();
    }
  return SplitBy(unknown).within;
}

PairInformation InformationOf(const std::vector<SurfacePairs>& captures, const Se3& T_map_moving,
                              const Directions& unknown, double voxel_m) {
  PairInformation information;
  const double distance_sigma_m = DistanceSigma_m(captures);
  BlockSums sums;
  for (const SurfacePairs& capture : captures)
    AddCapture(capture, T_map_moving.R(), distance_sigma_m, kBlockVoxels * voxel_m, sums);
  information.blocks = sums.blocks;
  const Directions B = SplitBy(unknown).across;
  const auto rank = static_cast<double>(B.cols()), blocks = static_cast<double>(sums.blocks);
  if (B.cols() == 0 || blocks < rank + 2) return information;
  const Eigen::MatrixXd H = B.transpose() * sums.H * B;
  const Eigen::MatrixXd inverse = H.inverse();
  const Eigen::MatrixXd C = kModelFactor * blocks / (blocks - rank) * inverse * (B.transpose() * sums.M * B) * inverse;
  information.Omega = Symmetrized(B * C.inverse() * B.transpose());
  return information;
}

}  // namespace rigcal::calib
