#include "server/calib/lidar_lidar/lidar_lidar_work.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "server/base/process/parallel_for.h"

namespace rigcal::calib {
namespace {

constexpr double kDenserRatio = 1.5;
constexpr double kStepCoarse = 2e-3, kStepFine = 3e-4, kStepLast = 1e-4;
constexpr std::size_t kStartCaptures = 3;
constexpr double kStartTurn_rad = 0.14, kStartShiftVoxels = 0.7;
constexpr double kHalfVoxels = 2;  // edge of the blocks that halves are made of

std::size_t PointsOf(const LidarLidarProblem& problem, std::vector<Eigen::Vector3f> LidarLidarCapture::*cloud) {
  std::size_t count = 0;
  for (const LidarLidarCapture& capture : problem.captures)
    if (IsUsable(capture)) count += (capture.*cloud).size();
  return count;
}

bool AIsMap(const LidarLidarProblem& problem) {
  const auto a = static_cast<double>(PointsOf(problem, &LidarLidarCapture::a_m)),
             b = static_cast<double>(PointsOf(problem, &LidarLidarCapture::b_m));
  if (std::max(a, b) > kDenserRatio * std::min(a, b)) return a > b;
  return problem.lidar_a.id < problem.lidar_b.id;
}

std::vector<Eigen::Vector3f> Shifted(std::vector<Eigen::Vector3f> points_m, double shift_m) {
  if (shift_m == 0) return points_m;
  for (Eigen::Vector3f& p : points_m) p += p.normalized() * static_cast<float>(shift_m);
  return points_m;
}

std::vector<NdtTerm> TermsOf(const LidarLidarWork& work, std::size_t level, const std::vector<std::size_t>& captures) {
  std::vector<NdtTerm> terms;
  for (const std::size_t i : captures) terms.push_back({&work.clouds[i].maps[level], &work.clouds[i].points[level]});
  return terms;
}

std::vector<std::size_t> Every(std::size_t step, std::size_t count) {
  std::vector<std::size_t> captures;
  for (std::size_t i = 0; i < count; i += step) captures.push_back(i);
  return captures;
}

double MetRatio(const NdtScore& score) { return score.points_met / std::max(score.points, 1.0); }

std::vector<NdtTerm> SurfaceTerms(const LidarLidarWork& work) {
  std::vector<NdtTerm> terms;
  for (const LidarClouds& clouds : work.clouds) terms.push_back({&clouds.surfaces, &clouds.points.back()});
  return terms;
}

std::vector<PolishTerm> PolishTerms(const LidarLidarWork& work) {
  std::vector<PolishTerm> terms;
  for (const LidarClouds& clouds : work.clouds) terms.push_back({&clouds.cells, &clouds.cells_moving});
  return terms;
}

// Which half a point belongs to: blocks like the squares of a board.
int HalfOf(const Eigen::Vector3d& p_m, double block_m) {
  const Eigen::Vector3i at = (p_m / block_m).array().floor().cast<int>();
  return (at.x() + at.y() + at.z()) & 1;
}

NormalSums NdtSums(const NdtMap& map, const std::vector<NdtPoint>& points, const Se3& T) {
  const NdtScore score = ScoreOf({{&map, &points}}, T);
  return {score.information, score.gradient};
}

NormalSums HalfSums(const LidarLidarWork& work, int half, const Se3& T) {
  const LidarClouds& clouds = work.clouds.front();
  const double block_m = kHalfVoxels * work.voxel_m;
  if (work.polish) return SumsOf(PolishTerm{&clouds.cells, &clouds.cells_moving, half, block_m}, T);
  std::vector<NdtPoint> points;
  for (const NdtPoint& point : clouds.points.back())
    if (HalfOf(point.p_m, block_m) == half) points.push_back(point);
  return NdtSums(clouds.surfaces, points, T);
}

// Of every block at the common pose.
std::vector<NormalSums> SumsOfBlocks(const LidarLidarWork& work, const Se3& T) {
  if (work.clouds.size() == 1) return {HalfSums(work, 0, T), HalfSums(work, 1, T)};
  std::vector<NormalSums> sums;
  for (const LidarClouds& clouds : work.clouds)
    sums.push_back(work.polish ? SumsOf(PolishTerm{&clouds.cells, &clouds.cells_moving}, T)
                               : NdtSums(clouds.surfaces, clouds.points.back(), T));
  return sums;
}

SurfacePairs PairsOfBlock(const LidarLidarWork& work, std::size_t block, const Se3& T) {
  if (work.clouds.size() > 1) return PairsOf(work.clouds[block], T);
  const SurfacePairs all = PairsOf(work.clouds.front(), T);
  SurfacePairs half;
  for (const SurfacePair& pair : all.pairs)
    if (HalfOf(pair.mean_moving_m, kHalfVoxels * work.voxel_m) == static_cast<int>(block)) half.pairs.push_back(pair);
  for (const NormalPair& pair : all.normals)
    if (HalfOf(pair.mean_moving_m, kHalfVoxels * work.voxel_m) == static_cast<int>(block)) half.normals.push_back(pair);
  return half;
}

}  // namespace

bool IsUsable(const LidarLidarCapture& capture) {
  return std::min(capture.a_m.size(), capture.b_m.size()) >= kCloudPointsMin;
}

LidarLidarWork WorkOf(const LidarLidarProblem& problem, const RangeShift& shift, bool with_cells) {
  LidarLidarWork work;
  work.a_is_map = AIsMap(problem);
  work.polish = problem.polish;
  work.nominal = work.a_is_map ? *problem.T_a_b_nominal : problem.T_a_b_nominal->Inverse();
  work.voxel_m = 0;
  for (std::size_t i = 0; i < problem.captures.size(); ++i) {
    const LidarLidarCapture& capture = problem.captures[i];
    if (!IsUsable(capture)) continue;
    work.used.push_back(i);
    work.voxel_m = std::max({work.voxel_m, FinestVoxel_m(capture.a_m), FinestVoxel_m(capture.b_m)});
  }
  work.clouds.resize(work.used.size());
  ParallelFor(work.used.size(), [&](std::size_t k) {
    const LidarLidarCapture& capture = problem.captures[work.used[k]];
    const auto a = Shifted(capture.a_m, shift.a_m), b = Shifted(capture.b_m, shift.b_m);
    work.clouds[k] =
        work.a_is_map ? CloudsOf(a, b, work.voxel_m, with_cells) : CloudsOf(b, a, work.voxel_m, with_cells);
  });
  return work;
}

LidarLidarPose FitFrom(const LidarLidarWork& work, const Se3& start, std::size_t first_level,
                       const Directions& locked) {
  LidarLidarPose pose;
  pose.ndt = start;
  const std::vector<std::size_t> all = Every(1, work.clouds.size());
  for (std::size_t level = first_level; level < kNdtLevels; ++level) {
    const double step_max = level + 1 < kNdtLevels ? kStepCoarse : kStepFine;
    const NdtFit fit = FitNdt(TermsOf(work, level, all), pose.ndt, step_max, locked);
    pose.ndt = fit.T_a_b;
    pose.met_ratio = MetRatio(fit.score);
  }
  const NdtFit last = FitNdt(SurfaceTerms(work), pose.ndt, kStepLast, locked);
  const Polished polished = Polish(PolishTerms(work), last.T_a_b, locked);
  pose.ndt = last.T_a_b;
  pose.polished = polished.T_a_b;
  pose.T = work.polish ? pose.polished : pose.ndt;
  pose.last_step = work.polish ? std::max(polished.last_step, last.last_step) : last.last_step;  // it builds on NDT's
  pose.converged = pose.last_step <= kNdtStepMax;
  return pose;
}

std::vector<std::size_t> StartCaptures(const LidarLidarWork& work) {
  return Every((work.clouds.size() + kStartCaptures - 1) / kStartCaptures, work.clouds.size());
}

StartEnd EndFrom(const LidarLidarWork& work, const Se3& start, std::size_t first_level) {
  const std::vector<std::size_t> few = StartCaptures(work);
  StartEnd end{start, 0, 0};
  for (std::size_t level = first_level; level < kNdtLevels; ++level) {
    const NdtFit fit = FitNdt(TermsOf(work, level, few), end.T, kStepCoarse);
    end = {fit.T_a_b, -fit.score.cost / std::max(fit.score.points, 1.0), MetRatio(fit.score)};
  }
  return end;
}

std::vector<StartEnd> TryStarts(const LidarLidarWork& work, std::size_t first_level) {
  std::vector<Vector6d> offsets{Vector6d::Zero()};
  for (int axis = 0; axis < 6; ++axis)
    for (const double sign : {1.0, -1.0})
      offsets.push_back(sign * (axis < 3 ? kStartShiftVoxels * work.voxel_m : kStartTurn_rad) * Vector6d::Unit(axis));
  std::vector<StartEnd> ends(offsets.size());
  ParallelFor(offsets.size(),
              [&](std::size_t i) { ends[i] = EndFrom(work, work.nominal * Se3::Exp(offsets[i]), first_level); });
  return ends;
}

Directions StepsTo(const Matrix6d& H, const Directions& gradients, const Directions& locked) {
  const Matrix6d keep = Matrix6d::Identity() - locked * locked.transpose();
  const double largest = std::max(H.diagonal().maxCoeff(), 1e-9);
  const Matrix6d solvable = keep * H * keep + largest * (locked * locked.transpose() + 1e-9 * Matrix6d::Identity());
  return -solvable.ldlt().solve(keep * gradients);
}

LidarLidarBlocks LeaveBlocksOut(const LidarLidarWork& work, const Se3& T, const Directions& locked) {
  const std::vector<NormalSums> sums = SumsOfBlocks(work, T);
  NormalSums all;
  for (const NormalSums& sum : sums) all.H += sum.H, all.g += sum.g;
  const auto step_without = [&](const Matrix6d& H, const Vector6d& g) { return Vector6d(StepsTo(H, g, locked)); };
  // What is left of the gradient at the common pose is no block's doing.
  const Vector6d common = step_without(all.H, all.g);
  LidarLidarBlocks blocks;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    blocks.d.push_back(step_without(all.H - sums[i].H, all.g - sums[i].g) - common);
    blocks.pairs.push_back(PairsOfBlock(work, i, T * Se3::Exp(blocks.d.back())));
  }
  return blocks;
}

}  // namespace rigcal::calib
