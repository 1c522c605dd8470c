#include "server/calib/core/diagnoses.h"
#include "server/calib/core/leave_one_out.h"
#include "server/calib/core/selection.h"
#include "server/calib/stereo/stereo_work.h"

namespace rigcal::calib {
namespace {

Result<Se3> WithoutBlockOf(const StereoProblem& problem, const StereoWork& solved, const CaptureBlock& block) {
  JointProblem joint = solved.joint;
  JointState state = solved.state;
  joint.captures.clear();
  state.T_a_board.clear();
  for (std::size_t k = 0; k < solved.used.size(); ++k) {
    if (block.captures.contains(problem.captures[solved.used[k]].capture)) continue;
    joint.captures.push_back(solved.joint.captures[k]);
    state.T_a_board.push_back(solved.state.T_a_board[k]);
  }
  RIGCAL_ASSIGN(const JointSolution solution, SolveJoint(joint, state, kSettledAgain_ratio));
  return solution.state.T_a_b;
}

StereoWork WithSquare(const StereoWork& solved, double scale) {
  StereoWork moved = solved;
  for (Eigen::Vector3d& corner : moved.joint.corners_board) corner *= scale;
  for (Se3& T_a_board : moved.state.T_a_board) T_a_board.p_m *= scale;
  moved.state.T_a_b.p_m *= scale;
  return moved;
}

Result<Se3> PoseOf(const StereoWork& solved) {
  RIGCAL_ASSIGN(const JointSolution solution, SolveJoint(solved.joint, solved.state, kSettledAgain_ratio));
  return solution.state.T_a_b;
}

void AddIntrinsics(const Sensor& camera, const std::vector<Vector6d>& shifts, const Se3& T_a_b,
                   std::vector<GivenConstant>& constants) {
  for (const Vector6d& shift : shifts)
    constants.push_back({IntrinsicsName(camera.id),
                         [&T_a_b, shift](double steps) { return Result<Se3>(T_a_b * Se3::Exp(steps * shift)); }});
}

std::vector<GivenConstant> ConstantsOf(const StereoProblem& problem, const StereoEstimate& estimate,
                                       const StereoWork& solved) {
  std::vector<GivenConstant> constants;
  AddBoardSize(
      problem.board, problem.board.square_sigma_m / problem.board.square_m,
      [&solved](double ratio) { return PoseOf(WithSquare(solved, 1 + ratio)); }, constants);
  AddIntrinsics(problem.camera_a, estimate.shifts_a, estimate.T_a_b, constants);
  AddIntrinsics(problem.camera_b, estimate.shifts_b, estimate.T_a_b, constants);
  return constants;
}

}  // namespace

Result<Uncertainty> Jackknife(const StereoProblem& problem, const StereoEstimate& estimate) {
  const StereoWork solved = WarmStart(problem, estimate);
  const std::vector<CaptureBlock> left_out = CaptureBlocks(problem.session_captures, CapturesAt(problem, solved.used));
  // Single views are left out too, but are no degrees of freedom of the pair.
  const std::size_t carrying = CountWith(left_out, SeenByBoth(problem));
  RIGCAL_ASSIGN(const std::vector<Contribution> contributions, ContributionsOf(ConstantsOf(problem, estimate, solved)));
  std::vector<BlockVector> blocks;
  if (carrying >= kCapturesForJackknife) {
    const auto without = [&](std::size_t k) { return WithoutBlockOf(problem, solved, left_out[k]); };
    RIGCAL_ASSIGN(blocks, LeaveOneOut(IdsOf(left_out), estimate.T_a_b, without));
  }
  return UncertaintyOf(estimate.C_model, std::move(blocks), contributions, carrying);
}

}  // namespace rigcal::calib
