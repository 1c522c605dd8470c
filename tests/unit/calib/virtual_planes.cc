#include "tests/unit/calib/virtual_planes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace rigcal::calib {
namespace {

using Random = std::mt19937;

Vector6d Normal6(Random& random, const PoseNoise& noise) {
  std::normal_distribution<double> normal(0, 1);
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? noise.translation_m : noise.rotation_rad) * normal(random);
  return xi;
}

// Where the middle of a plate's cell (u, v in -0.5 to 0.5) is.
std::vector<Eigen::Vector3d> GridOf(const Eigen::Vector2d& size_m) {
  std::vector<Eigen::Vector3d> grid;
  for (int row = 0; row < 8; ++row)
    for (int col = 0; col < 30; ++col)
      grid.emplace_back(size_m.x() * (-0.46 + 0.92 * col / 29), size_m.y() * (-0.45 + 0.9 * row / 7), 0);
  return grid;
}

bool IsSeen(const Se3& T_lidar_plate) {
  return T_lidar_plate.R().col(2).dot(T_lidar_plate.p_m.normalized()) > std::cos(75 * M_PI / 180);
}

PlanePatch PatchOf(const VirtualPlates& plates, const Se3& T_lidar_plate, Random& random) {
  std::normal_distribution<double> noise(0, 1);
  PlanePatch patch;
  patch.normal = -T_lidar_plate.R().col(2);
  patch.centre_m = T_lidar_plate.p_m + Eigen::Vector3d(0.03 * noise(random), 0.03 * noise(random), 0);
  patch.extent_m = {plates.size_m.maxCoeff(), plates.size_m.minCoeff()};
  patch.score = 0.9;
  for (const Eigen::Vector3d& cell : GridOf(plates.size_m)) {
    const Eigen::Vector3d p = T_lidar_plate * cell;
    const double shift_m = plates.range_sigma_m * noise(random) - plates.range_bias_m;
    patch.points_m.emplace_back((p + shift_m * p.normalized()).cast<float>());
  }
  return patch;
}

CloudView CloudOf(const VirtualPlates& plates, const Se3& T_world_lidar, Random& random) {
  CloudView cloud;
  cloud.points = 30000;
  std::uniform_real_distribution<double> place(-1, 1);
  for (const Se3& T_world_plate : plates.T_world_plate) {
    Se3 T_lidar_plate = T_world_lidar.Inverse() * T_world_plate;
    const double dx = place(random), dy = place(random), dz = place(random), tilt = place(random);
    if (plates.boards_move)
      T_lidar_plate = T_lidar_plate * Se3::Exp((Vector6d() << 2 * dx, 2 * dy, dz, tilt, dx, 0).finished());
    if (IsSeen(T_lidar_plate)) cloud.candidates.push_back(PatchOf(plates, T_lidar_plate, random));
  }
  for (int i = 0; plates.decoys && i < 2; ++i) {  // people and trolleys: anywhere, any tilt
    const double angle = M_PI * place(random), tilt = place(random), height = place(random);
    Se3 T_lidar_other;
    T_lidar_other.q = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) *
                      Eigen::AngleAxisd(M_PI / 2 + 0.5 * tilt, Eigen::Vector3d::UnitY());
    T_lidar_other.p_m = (3 + tilt) * T_lidar_other.R().col(2) + height * Eigen::Vector3d::UnitZ();
    cloud.candidates.insert(cloud.candidates.begin(), PatchOf(plates, T_lidar_other, random));
  }
  cloud.found = !cloud.candidates.empty();
  if (!cloud.found) cloud.why_not = "no flat patch of the plate's size";
  return cloud;
}

CaptureId CaptureNamed(std::size_t k) { return CaptureId(std::to_string(1000 + k).substr(1)); }

// Range of the ray along which the lidar at T_world_lidar met the plate, and where it would meet it had plate and lidar
// moved: the derivative of the measured range by what moves.
double RangeTo(const Se3& T_world_lidar, const Se3& T_world_plate, const Eigen::Vector3d& ray_lidar) {
  const Eigen::Vector3d normal = T_world_plate.R().col(2), ray = T_world_lidar.q * ray_lidar;
  return normal.dot(T_world_plate.p_m - T_world_lidar.p_m) / normal.dot(ray);
}

}  // namespace

VirtualPlates FourPlates() {
  VirtualPlates plates;
  const double yaws[] = {0.1, 1.7, -1.5}, heights[] = {0.2, -0.3, 0.4}, tilts[] = {0.15, -0.2, 0.1};
  for (int i = 0; i < 3; ++i) {
    Se3 T;
    T.q = Eigen::AngleAxisd(yaws[i], Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(M_PI / 2 + tilts[i], Eigen::Vector3d::UnitY());
    T.p_m = 4.5 * Eigen::Vector3d(std::cos(yaws[i]), std::sin(yaws[i]), 0) + heights[i] * Eigen::Vector3d::UnitZ();
    plates.T_world_plate.push_back(T);
  }
  Se3 above;
  above.q = Eigen::AngleAxisd(0.25, Eigen::Vector3d(1, 0.5, 0).normalized());
  above.p_m = {0.3, -0.2, 4.5};
  plates.T_world_plate.push_back(above);
  return plates;
}

TrackerLidarProblem Scanned(const VirtualBody& body, const VirtualPlates& plates, unsigned seed) {
  Random random(seed);
  TrackerLidarProblem problem;
  problem.tracker.id = SensorId("body");
  problem.tracker.kind = SensorKind::kTracker;
  problem.lidar.id = SensorId("top");
  problem.lidar.kind = SensorKind::kLidar;
  problem.tracker_is_a = true;
  problem.boards = {{TargetId("board"), 7, 5, 0.13, 0.0, ""}};
  problem.boards.front().plate_m = plates.size_m;
  if (plates.nominal)
    problem.T_body_lidar_nominal = body.X * Se3::Exp((Vector6d() << 0.02, -0.02, 0.02, 0.017, -0.017, 0.01).finished());
  for (std::size_t k = 0; k < body.T_world_a.size(); ++k) {
    const Se3 measured = (body.T_world_a[k] * Se3::Exp(Normal6(random, plates.tracker))).Normalized();
    problem.captures.push_back({CaptureNamed(k), measured, {CloudOf(plates, body.T_world_a[k] * body.X, random)}});
  }
  return problem;
}

Matrix6d BoundOf(const VirtualBody& body, const VirtualPlates& plates) {
  constexpr double kStep = 1e-6;
  const auto planes = static_cast<Eigen::Index>(plates.T_world_plate.size());
  const Eigen::Index size = 6 + 3 * planes;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  for (const Se3& T_world_body : body.T_world_a) {
    Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(6, size), shared = Eigen::MatrixXd::Zero(size, size);
    Matrix6d own = Matrix6d::Zero();
    own.diagonal() << Eigen::Vector3d::Constant(std::pow(plates.tracker.translation_m, -2)),
        Eigen::Vector3d::Constant(std::pow(plates.tracker.rotation_rad, -2));
    for (Eigen::Index b = 0; b < planes; ++b) {
      const Se3& T_world_plate = plates.T_world_plate[static_cast<std::size_t>(b)];
      const Se3 T_lidar_plate = (T_world_body * body.X).Inverse() * T_world_plate;
      if (!IsSeen(T_lidar_plate)) continue;
      // Lidar and plate, moved either way along each of: the lidar on the body, the body, the plate.
      std::array<std::array<std::pair<Se3, Se3>, 2>, 18> moved;
      for (std::size_t i = 0; i < 18; ++i)
        for (const std::size_t way : {0, 1}) {
          const Se3 step = Se3::Exp((way == 0 ? kStep : -kStep) * Vector6d::Unit(static_cast<int>(i % 6)));
          moved[i][way] = {i < 6    ? T_world_body * body.X * step
                           : i < 12 ? T_world_body * step * body.X
                                    : T_world_body * body.X,
                           i < 12 ? T_world_plate : T_world_plate * step};
        }
      for (const Eigen::Vector3d& cell : GridOf(plates.size_m)) {
        const Eigen::Vector3d ray = (T_lidar_plate * cell).normalized();
        const auto slope = [&](std::size_t i) {
          return (RangeTo(moved[i][0].first, moved[i][0].second, ray) -
                  RangeTo(moved[i][1].first, moved[i][1].second, ray)) /
                 (2 * kStep);
        };
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(size);
        Eigen::Matrix<double, 1, 6> by_body;
        for (std::size_t i = 0; i < 6; ++i) {
          row[static_cast<Eigen::Index>(i)] = slope(i);
          by_body[static_cast<Eigen::Index>(i)] = slope(6 + i);
        }
        // A plate turned in its plane or shifted along it is the same plane.
        for (std::size_t i = 2; i < 5; ++i) row[6 + 3 * b + static_cast<Eigen::Index>(i) - 2] = slope(12 + i);
        const double weight = std::pow(plates.range_sigma_m, -2);
        shared += weight * row.transpose() * row;
        mixed += weight * by_body.transpose() * row;
        own += weight * by_body.transpose() * by_body;
      }
    }
    H += shared - mixed.transpose() * own.inverse() * mixed;
  }
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(scale.asDiagonal() * H * scale.asDiagonal());
  if (!(axes.eigenvalues()[0] > 1e-12)) return Matrix6d::Constant(std::numeric_limits<double>::infinity());
  const Eigen::MatrixXd half = scale.asDiagonal() * axes.eigenvectors();
  return (half * axes.eigenvalues().cwiseInverse().asDiagonal() * half.transpose()).topLeftCorner<6, 6>();
}

}  // namespace rigcal::calib
