#include <Eigen/Cholesky>
#include <algorithm>

#include "server/calib/core/leave_one_out.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"
#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

Result<Se3> PoseFrom(const TrackerLidarProblem& problem, const StaticProblem& moved, const StaticState& start) {
  RIGCAL_ASSIGN(const StaticSolution solution, SolveStatic(moved, start));
  return EdgePose(problem, solution.state.T_body_lidar);
}

Result<Se3> WithoutBlockOf(const TrackerLidarProblem& problem, const TrackerLidarWork& work,
                           const CaptureBlock& block) {
  StaticProblem without = work.problem;
  StaticState start = work.state;
  for (std::size_t k = work.captures.size(); k-- > 0;) {
    if (!block.captures.contains(problem.captures[work.captures[k]].capture)) continue;
    EraseAt(k, without.captures, start.T_world_body);
  }
  return PoseFrom(problem, without, start);
}

std::vector<char> BeamsSeen(const TrackerLidarWork& work) {
  std::vector<char> seen(kBeamGroups, 0);
  for (const auto& patches : work.patches)
    for (const ChosenPatch& chosen : patches) MarkBeams(*chosen.patch, seen);
  return seen;
}

std::vector<GivenConstant> ConstantsOf(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  std::vector<GivenConstant> constants;
  const auto with_bias = [&problem, &work](double longer_m) {
    StaticProblem moved = work.problem;
    moved.range_bias_m += longer_m;
    return PoseFrom(problem, moved, work.state);
  };
  const auto with_beams = [&problem, &work](std::size_t group, double longer_m) {
    return PoseFrom(problem, ProblemWithBeamsMoved(work, group, longer_m), work.state);
  };
  AddRangeBias(problem.lidar.id, problem.lidar.range_bias_sigma_m.value_or(0.0), with_bias, constants);
  AddBeams(problem.lidar, BeamsSeen(work), EdgePose(problem, work.state.T_body_lidar), with_beams, constants);
  return constants;
}

// In the edge's own tangent, right at b: X^-1 Exp(-Ad(X) xi) = (X Exp(xi))^-1.
struct OfEdge {
  Directions free;
  Matrix6d information;
};

OfEdge InEdge(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  const Matrix6d information = ModelInformation(work);
  if (problem.tracker_is_a) return {work.problem.free, information};
  const Se3& X = work.state.T_body_lidar;
  return {SplitBy(Adjoint(X) * work.reach.open).across, InverseInformation(X, information)};
}

}  // namespace

Se3 EdgePose(const TrackerLidarProblem& problem, const Se3& T_body_lidar) {
  return problem.tracker_is_a ? T_body_lidar : T_body_lidar.Inverse();
}

Matrix6d ModelInformation(const TrackerLidarWork& work) {
  // Never better than the noise that was put in: a few captures may fit by luck.
  const double factor = work.fit.dof > 0 ? std::max(1.0, work.fit.chi2 / work.fit.dof) : 1.0;
  const auto& free = work.problem.free;
  const Eigen::MatrixXd along =
      work.fit.C_lidar.llt().solve(Eigen::MatrixXd::Identity(free.cols(), free.cols())) / factor;
  return Symmetrized(free * along * free.transpose());
}

Result<Uncertainty> JackknifeTrackerLidar(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  RIGCAL_ASSIGN(std::vector<Contribution> contributions, ContributionsOf(ConstantsOf(problem, work)));
  std::vector<BlockVector> blocks;
  const std::vector<CaptureBlock> left_out =
      CaptureBlocks(problem.session_captures, CapturesAt(problem, work.captures));
  if (left_out.size() >= kTrackerLidarForJackknife) {
    const auto without = [&](std::size_t k) { return WithoutBlockOf(problem, work, left_out[k]); };
    RIGCAL_ASSIGN(blocks, LeaveOneOut(IdsOf(left_out), EdgePose(problem, work.state.T_body_lidar), without));
  }
  const OfEdge edge = InEdge(problem, work);
  const Eigen::MatrixXd along = edge.free.transpose() * edge.information * edge.free;
  const Eigen::MatrixXd C = along.llt().solve(Eigen::MatrixXd::Identity(along.rows(), along.cols()));
  return UncertaintyAlong(edge.free, C, std::move(blocks), std::move(contributions), left_out.size());
}

}  // namespace rigcal::calib
