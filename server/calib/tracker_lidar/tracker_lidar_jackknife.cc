#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "server/calib/core/beam_groups.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"
#include "server/math/covariance.h"

namespace rigcal::calib {
namespace {

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

Se3 EdgePose(const TrackerLidarProblem& problem, const Se3& T_body_lidar) {
  return problem.tracker_is_a ? T_body_lidar : T_body_lidar.Inverse();
}

Result<Se3> PoseFrom(const TrackerLidarProblem& problem, const StaticProblem& moved, const StaticState& start) {
  RIGCAL_ASSIGN(const StaticSolution solution, SolveStatic(moved, start));
  return EdgePose(problem, solution.state.T_body_lidar);
}

Result<Vector6d> WithoutBlockOf(const TrackerLidarProblem& problem, const TrackerLidarWork& work,
                                const CaptureBlock& block) {
  StaticProblem without = work.problem;
  StaticState start = work.state;
  for (std::size_t k = work.captures.size(); k-- > 0;) {
    if (!block.captures.contains(problem.captures[work.captures[k]].capture)) continue;
    without.captures.erase(without.captures.begin() + static_cast<std::ptrdiff_t>(k));
    start.T_world_body.erase(start.T_world_body.begin() + static_cast<std::ptrdiff_t>(k));
  }
  RIGCAL_ASSIGN(const Se3 T_a_b, PoseFrom(problem, without, start));
  return Vector6d((EdgePose(problem, work.state.T_body_lidar).Inverse() * T_a_b).Log());
}

std::vector<CaptureBlock> BlocksOf(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  std::set<CaptureId> used;
  for (const std::size_t idx : work.captures) used.insert(problem.captures[idx].capture);
  return CaptureBlocks(problem.session_captures, used);
}

std::vector<char> BeamsSeen(const TrackerLidarWork& work) {
  std::vector<char> seen(kBeamGroups, 0);
  for (const auto& patches : work.patches)
    for (const ChosenPatch& chosen : patches) MarkBeams(*chosen.patch, seen);
  return seen;
}

// Every group of beams errs by the given sigma alone as well.
void AddBeams(const TrackerLidarProblem& problem, const TrackerLidarWork& work, double sigma_m,
              std::vector<GivenConstant>& constants) {
  const std::vector<char> seen = BeamsSeen(work);
  for (std::size_t group = 0; group < seen.size(); ++group)
    constants.push_back({SingleBeamsOf(problem.lidar.id),
                         [&problem, &work, sigma_m, group, is_seen = seen[group]](double steps) -> Result<Se3> {
                           if (is_seen == 0) return EdgePose(problem, work.state.T_body_lidar);
                           return PoseFrom(problem, ProblemWithBeamsMoved(work, group, steps * sigma_m), work.state);
                         }});
}

std::vector<GivenConstant> ConstantsOf(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  const double sigma_m = problem.lidar.range_bias_sigma_m.value_or(0.0);
  if (!(sigma_m > 0)) return {};
  std::vector<GivenConstant> constants = {
      {"range bias of " + problem.lidar.id.str(), [&problem, &work, sigma_m](double steps) {
         StaticProblem moved = work.problem;
         moved.range_bias_m += steps * sigma_m;
         return PoseFrom(problem, moved, work.state);
       }}};
  AddBeams(problem, work, sigma_m, constants);
  return constants;
}

// In the edge's own tangent, right at b: X^-1 Exp(-Ad(X) xi) = (X Exp(xi))^-1.
struct OfEdge {
  Columns free;
  Matrix6d information;
};

OfEdge InEdge(const TrackerLidarProblem& problem, const TrackerLidarWork& work) {
  const Matrix6d information = ModelInformation(work);
  if (problem.tracker_is_a) return {work.problem.free, information};
  const Se3& X = work.state.T_body_lidar;
  const Eigen::Index open = work.reach.open.cols();
  if (open == 0) return {Matrix6d::Identity(), InverseInformation(X, information)};
  const Columns turned = Adjoint(X) * work.reach.open;
  const Matrix6d Q = Eigen::HouseholderQR<Columns>(turned).householderQ();
  return {Q.rightCols(6 - open), InverseInformation(X, information)};
}

}  // namespace

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
  const std::vector<CaptureBlock> left_out = BlocksOf(problem, work);
  if (left_out.size() >= kTrackerLidarForJackknife) {
    const auto without = [&](std::size_t k) { return WithoutBlockOf(problem, work, left_out[k]); };
    RIGCAL_ASSIGN(blocks, LeaveOneOut(IdsOf(left_out), without));
  }
  const OfEdge edge = InEdge(problem, work);
  const Eigen::MatrixXd along = edge.free.transpose() * edge.information * edge.free;
  const Eigen::MatrixXd C = along.llt().solve(Eigen::MatrixXd::Identity(along.rows(), along.cols()));
  return UncertaintyAlong(edge.free, C, std::move(blocks), std::move(contributions), left_out.size());
}

}  // namespace rigcal::calib
