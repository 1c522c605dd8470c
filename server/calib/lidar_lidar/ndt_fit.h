// NDT: a Gaussian for every occupied voxel of one cloud (Biber & Strasser 2003; Magnusson 2009), and the pose that puts
// another cloud where these expect points. Own Newton iteration, converged.
#pragma once

#include <vector>

#include "server/calib/core/directions.h"
#include "server/calib/lidar_lidar/moment_grid.h"
#include "server/math/se3.h"

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
  CellIndex index;
  std::vector<NdtVoxel> voxels;  // by the index's numbers; voxels of too few points are not there
};

constexpr double kNdtPointsMin = 6;  // of a voxel that has a Gaussian

// Of cells of kNdtPointsMin points and more; with NdtKind::kSurfaces only of flat ones.
[[nodiscard]] NdtMap NdtMapOf(const MomentGrid& grid, NdtKind kind);

// A point of the moving cloud: the mean of a cell, as many points as `weight` says.
struct NdtPoint {
  Eigen::Vector3d p_m;
  double weight = 1;
};
// One for each cell, in the order of their numbers; a cell of very many points weighs no more than a limit.
[[nodiscard]] std::vector<NdtPoint> NdtPointsOf(const MomentGrid& grid);

// Clouds of one capture at one level. Frames: the map is a's, the points are b's.
struct NdtTerm {
  const NdtMap* map = nullptr;
  const std::vector<NdtPoint>* points = nullptr;
};

// Sum over the points of -weight * exp(-d2/2 e^T W e) (Magnusson's score), over every voxel that a point lies in or
// beside: smaller is better. Gradient and Gauss-Newton information for T_a_b * Exp(xi).
struct NdtScore {
  double cost = 0;
  Vector6d gradient = Vector6d::Zero();
  Matrix6d information = Matrix6d::Zero();
  double points = 0, points_met = 0;  // all, and those with a voxel: weights
};
// Sum over the terms, alike on any number of threads.
[[nodiscard]] NdtScore ScoreOf(const std::vector<NdtTerm>& terms, const Se3& T_a_b);

// Causes that each move a point (frame of the moving cloud) or the mean of a voxel (frame of the map).
struct NdtMove {
  std::size_t cause = 0;
  Eigen::Vector3d by_m = Eigen::Vector3d::Zero();
};
struct NdtMoves {
  std::vector<std::vector<NdtMove>> of_points, of_voxels;  // side by side with the term's
};
// What one unit of each cause does to the gradient, a column each; Gauss-Newton as the information.
[[nodiscard]] Directions GradientByMoves(const NdtTerm& term, const NdtMoves& moves, std::size_t causes,
                                         const Se3& T_a_b);

struct NdtFit {
  Se3 T_a_b;
  NdtScore score;
  double last_step = 0;  // norm of the last step tried: m and rad
  int iterations = 0;
  bool converged = false;
};
constexpr double kNdtStepMax = 1e-4;  // of a converged fit's last step

// Minimum from a start. `locked`: orthonormal directions (columns, in the right tangent at b) in which the pose stays.
// Bit for bit the same on any number of threads.
[[nodiscard]] NdtFit FitNdt(const std::vector<NdtTerm>& terms, const Se3& start, double step_max,
                            const Directions& locked = Directions(6, 0));

}  // namespace rigcal::calib
