#include "server/calib/lidar_lidar/ndt_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
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

constexpr std::size_t kChunk = 1024;  // points; fixed, so that sums do not depend on threads
constexpr int kIterationsMax = 40;
constexpr double kTurnMax_rad = 0.15, kShiftMax_m = 1.0;  // of one step
constexpr double kOutlierRatio = 0.55;
constexpr double kWeightMax = 8;  // of one cell: its points share their errors

// Magnusson's d2: the exponent of the Gaussian that comes nearest to a normal distribution mixed with outliers.
double ExponentOf(double voxel_m) {
  const double c1 = 10 * (1 - kOutlierRatio), c2 = kOutlierRatio / (voxel_m * voxel_m * voxel_m);
  const double d3 = -std::log(c2), d1 = -std::log(c1 + c2) - d3;
  return -2 * std::log((-std::log(c1 * std::exp(-0.5) + c2) - d3) / d1);
}

// Sums in the frame of the map, about its origin: for Exp(xi) * T.
struct LeftSums {
  double cost = 0, points = 0, points_met = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  Eigen::Matrix3d tt = Eigen::Matrix3d::Zero(), tr = Eigen::Matrix3d::Zero(), rr = Eigen::Matrix3d::Zero();

  void Add(const LeftSums& other) {
    cost += other.cost, points += other.points, points_met += other.points_met;
    force += other.force, torque += other.torque;
    tt += other.tt, tr += other.tr, rr += other.rr;
  }
};

constexpr std::array<std::array<int, 3>, 7> kNeighbours = {
    {{0, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// What the voxels about q say of a point there: force, information and cost, all for one point.
struct Pull {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double cost = 0;
  bool met = false;
};

Pull PullOf(const NdtMap& map, double per_m, double d2, const Eigen::Vector3d& q) {
  Pull pull;
  const int x = static_cast<int>(std::floor(q.x() * per_m)), y = static_cast<int>(std::floor(q.y() * per_m)),
            z = static_cast<int>(std::floor(q.z() * per_m));
  for (const auto& [dx, dy, dz] : kNeighbours) {
    const int number = map.index.Find(CellKeyOf(x + dx, y + dy, z + dz));
    if (number < 0) continue;
    const NdtVoxel& voxel = map.voxels[static_cast<std::size_t>(number)];
    const Eigen::Vector3d e = q - voxel.mean_m, We = voxel.information * e;
    const double weight = std::exp(-0.5 * d2 * e.dot(We));
    pull.cost -= weight;
    pull.met = true;
    if (weight < 1e-4) continue;
    pull.force += d2 * weight * We;
    pull.information += d2 * weight * voxel.information;
  }
  return pull;
}

LeftSums SumsOf(const NdtTerm& term, std::size_t begin, std::size_t end, const Se3& T_a_b) {
  const double per_m = 1 / term.map->voxel_m, d2 = ExponentOf(term.map->voxel_m);
  const Eigen::Matrix3d R = T_a_b.R();
  LeftSums sums;
  for (std::size_t i = begin; i < end; ++i) {
    const NdtPoint& point = (*term.points)[i];
    const Eigen::Vector3d q = R * point.p_m + T_a_b.p_m;
    sums.points += point.weight;
    if (!(q.cwiseAbs().maxCoeff() * per_m < kCellsMax - 4)) continue;
    const Pull pull = PullOf(*term.map, per_m, d2, q);
    if (!pull.met) continue;
    sums.points_met += point.weight;
    sums.cost += point.weight * pull.cost;
    const Eigen::Vector3d force = point.weight * pull.force;
    const Eigen::Matrix3d A = point.weight * pull.information, Q = Hat(q), AQ = A * Q;
    sums.force += force;
    sums.torque += q.cross(force);
    sums.tt += A;
    sums.tr -= AQ;
    sums.rr -= Q * AQ;  // Q^T A Q, as Q^T = -Q
  }
  return sums;
}

NdtScore RightScore(const LeftSums& sums, const Se3& T_a_b) {
  Matrix6d H;
  H << sums.tt, sums.tr, sums.tr.transpose(), sums.rr;
  Vector6d g;
  g << sums.force, sums.torque;
  const Matrix6d Ad = Adjoint(T_a_b);  // T Exp(xi) = Exp(Ad xi) T
  NdtScore score;
  score.cost = sums.cost;
  score.gradient = Ad.transpose() * g;
  score.information = Ad.transpose() * H * Ad;
  score.points = sums.points;
  score.points_met = sums.points_met;
  return score;
}

// Left, of all causes, for one point and the voxels about it.
void AddMoves(const NdtMap& map, const NdtMoves& moves, std::size_t point, const NdtPoint& moving, const Se3& T_a_b,
              Directions& left) {
  const double per_m = 1 / map.voxel_m, d2 = ExponentOf(map.voxel_m);
  const Eigen::Vector3d q = T_a_b * moving.p_m;
  if (!(q.cwiseAbs().maxCoeff() * per_m < kCellsMax - 4)) return;
  const Eigen::Vector3i at = (q * per_m).array().floor().cast<int>();
  const Eigen::Matrix3d R = T_a_b.R();
  for (const auto& [dx, dy, dz] : kNeighbours) {
    const int number = map.index.Find(CellKeyOf(at.x() + dx, at.y() + dy, at.z() + dz));
    if (number < 0) continue;
    const NdtVoxel& voxel = map.voxels[static_cast<std::size_t>(number)];
    const Eigen::Vector3d e = q - voxel.mean_m;
    const double weight = moving.weight * d2 * std::exp(-0.5 * d2 * e.dot(voxel.information * e));
    const auto add = [&](std::size_t cause, const Eigen::Vector3d& moved_m) {
      const Eigen::Vector3d force = weight * (voxel.information * moved_m);
      left.col(static_cast<Eigen::Index>(cause)).head<3>() += force;
      left.col(static_cast<Eigen::Index>(cause)).tail<3>() += q.cross(force);
    };
    for (const NdtMove& move : moves.of_points[point]) add(move.cause, R * move.by_m);
    for (const NdtMove& move : moves.of_voxels[static_cast<std::size_t>(number)]) add(move.cause, -move.by_m);
  }
}

Vector6d Limited(Vector6d step) {
  const double excess = std::max(step.head<3>().norm() / kShiftMax_m, step.tail<3>().norm() / kTurnMax_rad);
  if (excess > 1) step /= excess;
  return step;
}

// Damped step that leaves the locked directions alone.
Vector6d StepOf(const NdtScore& score, double damping, const Directions& locked) {
  Matrix6d H = score.information;
  const Vector6d diagonal = H.diagonal();
  H.diagonal() += damping * diagonal + Vector6d::Constant(1e-9 * diagonal.maxCoeff());
  Vector6d g = score.gradient;
  if (locked.cols() > 0) {
    const Matrix6d keep = Matrix6d::Identity() - locked * locked.transpose();
    H = keep * H * keep + diagonal.maxCoeff() * locked * locked.transpose();
    g = keep * g;
  }
  return Limited(-H.ldlt().solve(g));
}

}  // namespace

NdtMap NdtMapOf(const MomentGrid& grid, NdtKind kind) {
  NdtMap map{grid.cell_m, CellIndex(grid.cells.size() / 2), {}};
  for (std::size_t i = 0; i < grid.cells.size(); ++i) {
    if (grid.cells[i].count < kNdtPointsMin) continue;
    NdtVoxel voxel = VoxelOf(grid.cells[i], kind);
    if (kind == NdtKind::kSurfaces && !voxel.flat) continue;
    map.index.Add(grid.index.keys()[i]);
    map.voxels.push_back(std::move(voxel));
  }
  return map;
}

std::vector<NdtPoint> NdtPointsOf(const MomentGrid& grid) {
  std::vector<NdtPoint> points;
  points.reserve(grid.cells.size());
  for (const Moments& cell : grid.cells) points.push_back({cell.Mean(), std::min(cell.count, kWeightMax)});
  return points;
}

NdtScore ScoreOf(const std::vector<NdtTerm>& terms, const Se3& T_a_b) {
  const auto parts = SumsOfChunks<LeftSums>(
      terms, kChunk, [](const NdtTerm& term) { return term.points->size(); },
      [&](const NdtTerm& term, std::size_t begin, std::size_t end) { return SumsOf(term, begin, end, T_a_b); });
  LeftSums sums;
  for (const LeftSums& part : parts) sums.Add(part);
  return RightScore(sums, T_a_b);
}

Directions GradientByMoves(const NdtTerm& term, const NdtMoves& moves, std::size_t causes, const Se3& T_a_b) {
  Directions left(6, static_cast<Eigen::Index>(causes));
  left.setZero();
  for (std::size_t i = 0; i < term.points->size(); ++i) AddMoves(*term.map, moves, i, (*term.points)[i], T_a_b, left);
  return Adjoint(T_a_b).transpose() * left;
}

NdtFit FitNdt(const std::vector<NdtTerm>& terms, const Se3& start, double step_max, const Directions& locked) {
  NdtFit fit{start, ScoreOf(terms, start), 0, 0, false};
  double damping = 1e-4;
  while (fit.iterations < kIterationsMax && !fit.converged) {
    ++fit.iterations;
    const Vector6d step = StepOf(fit.score, damping, locked);
    if (!step.allFinite()) break;
    fit.last_step = step.norm();
    const Se3 moved = (fit.T_a_b * Se3::Exp(step)).Normalized();
    const NdtScore score = ScoreOf(terms, moved);
    if (score.cost <= fit.score.cost) {
      fit.T_a_b = moved;
      fit.score = score;
      damping = std::max(damping / 10, 1e-6);
    } else {
      damping = std::min(std::max(10 * damping, 1e-3), 1e6);
    }
    fit.converged = fit.last_step <= step_max;
  }
  return fit;
}

}  // namespace rigcal::calib
