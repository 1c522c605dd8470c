#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <set>

#include "server/base/process/parallel_for.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "server/math/jackknife.h"

namespace rigcal::calib {
namespace {

// Causes: the groups of the map's lidar, then those of the moving one.
constexpr std::size_t kCauses = 2 * kBeamGroups;

// A voxel's mean moves by the share of it that the group's points are.
void AddPoint(const Eigen::Vector3f& p_m, double count, std::vector<NdtMove>& moves) {
  const std::size_t group = BeamGroupOf(p_m);
  const Eigen::Vector3d share = p_m.cast<double>().normalized() / count;
  for (NdtMove& move : moves)
    if (move.cause == group) {
      move.by_m += share;
      return;
    }
  moves.push_back({group, share});
}

std::vector<std::vector<NdtMove>> MovesOfVoxels(const NdtMap& map, const std::vector<Eigen::Vector3f>& points_m) {
  std::vector<std::vector<NdtMove>> moves(map.voxels.size());
  for (const Eigen::Vector3f& p : points_m) {
    const Eigen::Vector3d scaled = p.cast<double>() / map.voxel_m;
    if (!(scaled.cwiseAbs().maxCoeff() < kCellsMax - 4)) continue;
    const Eigen::Vector3i at = scaled.array().floor().cast<int>();
    const int number = map.index.Find(CellKeyOf(at.x(), at.y(), at.z()));
    if (number < 0) continue;
    const auto voxel = static_cast<std::size_t>(number);
    AddPoint(p, map.voxels[voxel].count, moves[voxel]);
  }
  return moves;
}

// A cell is a quarter of a voxel wide: it counts as of one group.
std::vector<std::vector<NdtMove>> MovesOfPoints(const std::vector<NdtPoint>& points) {
  std::vector<std::vector<NdtMove>> moves;
  moves.reserve(points.size());
  for (const NdtPoint& point : points)
    moves.push_back({{kBeamGroups + BeamGroupOf(point.p_m.cast<float>()), point.p_m.normalized()}});
  return moves;
}

struct Sums {
  Matrix6d H = Matrix6d::Zero();
  Directions gradients = Directions::Zero(6, kCauses);
};

Sums SumsOfCapture(const LidarLidarProblem& problem, const LidarLidarWork& work, std::size_t k, const Se3& T) {
  const LidarLidarCapture& capture = problem.captures[work.used[k]];
  const LidarClouds& clouds = work.clouds[k];
  const NdtTerm term{&clouds.surfaces, &clouds.points.back()};
  const NdtMoves moves{MovesOfPoints(clouds.points.back()),
                       MovesOfVoxels(clouds.surfaces, work.a_is_map ? capture.a_m : capture.b_m)};
  return {ScoreOf({term}, T).information, GradientByMoves(term, moves, kCauses, T)};
}

// How T_map_moving (right tangent) changes per metre that the ranges of each group of beams are longer, one column per
// group (leave_one_out.h): of the lidar that makes the map, of the one that moves. Linear at the pose: a group more
// is one more right side, not one more registration. Zero along `unknown`.
struct BeamShifts {
  Directions of_map, of_moving;
};

BeamShifts ShiftsByBeams(const LidarLidarProblem& problem, const LidarLidarWork& work, const Se3& T_map_moving,
                         const Directions& unknown) {
  std::vector<Sums> captures(work.clouds.size());
  ParallelFor(captures.size(), [&](std::size_t k) { captures[k] = SumsOfCapture(problem, work, k, T_map_moving); });
  Sums all;
  for (const Sums& one : captures) all.H += one.H, all.gradients += one.gradients;
  const Directions steps = StepsTo(all.H, all.gradients, unknown);
  return {steps.leftCols(kBeamGroups), steps.rightCols(kBeamGroups)};
}

// What the two methods disagree by is one draw of an error that all captures share, so that neither the jackknife nor
// the scatter within the clouds shows it. It arises where the pose rests on the surfaces, as chance does, and so has
// the shape of the covariance by chance, along the columns of B. The scale of a covariance of known shape is, of one
// draw, its mean square over the directions; the draw's own direction alone would leave the five others without any.
// A polished pose is NDT's, whose error that is, and the way from there, which is as large: it has both.
Contribution MethodContribution(const LidarLidarPose& pose, bool polished, const Directions& B, const Matrix6d& C) {
  const Eigen::MatrixXd along = B.transpose() * C * B;
  const Eigen::VectorXd apart = B.transpose() * (pose.ndt.Inverse() * pose.polished).Log();
  const double scale = (polished ? 2 : 1) * apart.dot(along.ldlt().solve(apart)) / static_cast<double>(B.cols());
  return {"method (NDT against GICP)", scale * Symmetrized(B * along * B.transpose())};
}

Result<std::vector<Contribution>> RangeContributions(const LidarLidarProblem& problem, const Se3& T_map_moving,
                                                     const Directions& unknown) {
  std::vector<GivenConstant> constants;
  const auto add = [&](const Sensor& lidar, double RangeShift::*shift_m) {
    const auto with_bias = [&, shift_m](double longer_m) -> Result<Se3> {
      RangeShift shift;
      shift.*shift_m = longer_m;
      return FitFrom(WorkOf(problem, shift), T_map_moving, kNdtLevels - 1, unknown).T;
    };
    AddRangeBias(lidar.id, lidar.range_bias_sigma_m.value_or(0.0), with_bias, constants);
  };
  add(problem.lidar_a, &RangeShift::a_m);
  add(problem.lidar_b, &RangeShift::b_m);
  return ContributionsOf(constants);
}

// Every group of beams errs by the given sigma alone as well.
void AddBeams(const Sensor& lidar, const Directions& shifts, std::vector<Contribution>& contributions) {
  const double sigma_m = lidar.range_bias_sigma_m.value_or(0.0);
  if (!(sigma_m > 0)) return;
  Contribution beams{SingleBeamsOf(lidar.id), Matrix6d(sigma_m * sigma_m * shifts * shifts.transpose())};
  for (Eigen::Index group = 0; group < shifts.cols(); ++group) beams.shifts.push_back(sigma_m * shifts.col(group));
  contributions.push_back(std::move(beams));
}

void AddBeams(const LidarLidarProblem& problem, const LidarLidarWork& work, const Se3& T_map_moving,
              const Directions& unknown, std::vector<Contribution>& contributions) {
  if (!(std::max(problem.lidar_a.range_bias_sigma_m.value_or(0.0), problem.lidar_b.range_bias_sigma_m.value_or(0.0)) >
        0))
    return;
  const BeamShifts shifts = ShiftsByBeams(problem, work, T_map_moving, unknown);
  AddBeams(problem.lidar_a, work.a_is_map ? shifts.of_map : shifts.of_moving, contributions);
  AddBeams(problem.lidar_b, work.a_is_map ? shifts.of_moving : shifts.of_map, contributions);
}

// What is left out at once. Without several captures the pose goes, to first order, where each of them would take it.
std::vector<BlockVector> BlockVectors(const LidarLidarProblem& problem, const LidarLidarWork& work,
                                      const std::vector<Vector6d>& d) {
  std::map<CaptureId, Vector6d> of_capture;
  std::set<CaptureId> used;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const CaptureId& capture = problem.captures[work.used[k]].capture;
    of_capture[capture] = d[k];
    used.insert(capture);
  }
  std::vector<BlockVector> blocks;
  for (const CaptureBlock& block : CaptureBlocks(problem.session_captures, used)) {
    Vector6d sum = Vector6d::Zero();
    for (const CaptureId& capture : block.captures) sum += of_capture.at(capture);
    blocks.push_back({block.id, sum});
  }
  return blocks;
}

}  // namespace

Result<Uncertainty> LidarLidarUncertainty(const LidarLidarProblem& problem, const LidarLidarWork& work,
                                          const LidarLidarPose& pose, const Directions& unknown,
                                          const std::vector<SurfacePairs>& pairs, const std::vector<Vector6d>& d) {
  const Se3& T_map_moving = pose.T;
  const PairInformation model = InformationOf(pairs, T_map_moving, unknown, work.voxel_m);
  const Directions B = SplitBy(unknown).across;
  const auto failed = [] {
    return Fail(ErrorCode::kInvalidInput, "the common surroundings fix the pose too weakly",
                "Take captures where both see walls or objects facing three different ways.");
  };
  const Eigen::MatrixXd known = B.transpose() * model.Omega * B;
  if (!known.allFinite() || !(known.diagonal().minCoeff() > 0)) return failed();
  const Matrix6d C_model = B * known.inverse() * B.transpose();
  const bool each_left_out = d.size() == work.used.size();
  std::vector<BlockVector> blocks = each_left_out ? BlockVectors(problem, work, d) : std::vector<BlockVector>{};
  const std::size_t m = blocks.size();
  const bool jackknife = m >= kCloudsForJackknife;
  Matrix6d C = jackknife ? JackknifeOrModel(VectorsOf(blocks), C_model) : C_model;
  RIGCAL_ASSIGN(std::vector<Contribution> contributions, RangeContributions(problem, T_map_moving, unknown));
  AddBeams(problem, work, T_map_moving, unknown, contributions);
  contributions.push_back(MethodContribution(pose, work.polish, B, C));
  for (const Contribution& contribution : contributions) C += contribution.covariance;
  Matrix6d Omega = Symmetrized(B * (B.transpose() * C * B).inverse() * B.transpose());
  if (!Omega.allFinite()) return failed();
  const Matrix6d Ad = Adjoint(T_map_moving);
  if (!work.a_is_map) Omega = Symmetrized(InverseInformation(T_map_moving, Omega));
  const int dof = static_cast<int>(jackknife ? m : model.blocks) - 1;
  Uncertainty uncertainty =
      FromInformation(Omega, jackknife ? UncertaintySource::kJackknife : UncertaintySource::kModel, dof);
  if (uncertainty.rank != B.cols()) return failed();
  for (Contribution& contribution : contributions) {
    if (work.a_is_map) break;
    contribution.covariance = InverseCovariance(T_map_moving, contribution.covariance);
    for (Vector6d& shift : contribution.shifts) shift = -Ad * shift;
  }
  uncertainty.contributions = std::move(contributions);
  if (!jackknife) return uncertainty;
  for (BlockVector& block : blocks)
    if (!work.a_is_map) block.d = -Ad * block.d;
  uncertainty.blocks = std::move(blocks);
  return uncertainty;
}

}  // namespace rigcal::calib
