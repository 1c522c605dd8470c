#include "server/math/jackknife.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "server/base/parallel_for.h"
#include "server/calib/diagnoses.h"
#include "server/calib/joint_problem.h"
#include "server/calib/selection.h"
#include "server/calib/stereo.h"

namespace rigcal::calib {
namespace {

// The solved problem, ready to be solved again with something changed.
struct Solved {
  std::vector<std::size_t> used;
  JointProblem joint;
  JointState state;
};

Solved SolvedOf(const StereoProblem& problem, const StereoEstimate& estimate) {
  Solved solved;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const auto board = estimate.T_a_board.find(problem.captures[idx].capture);
    if (board == estimate.T_a_board.end()) continue;
    solved.used.push_back(idx);
    solved.state.T_a_board.push_back(board->second);
  }
  solved.joint = JointOf(problem, solved.used);
  solved.state.intrinsics_a = VectorOf(estimate.intrinsics_a);
  solved.state.intrinsics_b = VectorOf(estimate.intrinsics_b);
  solved.state.T_a_b = estimate.T_a_b;
  return solved;
}

Result<Vector6d> WithoutCapture(const Solved& solved, std::size_t k) {
  JointProblem joint = solved.joint;
  JointState state = solved.state;
  joint.captures.erase(joint.captures.begin() + static_cast<std::ptrdiff_t>(k));
  state.T_a_board.erase(state.T_a_board.begin() + static_cast<std::ptrdiff_t>(k));
  RIGCAL_ASSIGN(const JointSolution solution, SolveJoint(joint, state));
  return Vector6d((solved.state.T_a_b.Inverse() * solution.state.T_a_b).Log());
}

Result<std::vector<BlockVector>> LeaveOneOut(const StereoProblem& problem, const Solved& solved) {
  std::vector<std::optional<Result<Vector6d>>> without(solved.used.size());
  ParallelFor(without.size(), [&](std::size_t k) { without[k] = WithoutCapture(solved, k); });
  std::vector<BlockVector> blocks;
  for (std::size_t k = 0; k < without.size(); ++k) {
    const std::string& capture = problem.captures[solved.used[k]].capture.str();
    const Result<Vector6d>& d = *without[k];
    if (!d)
      return Fail(ErrorCode::kInvalidInput, "without capture " + capture + " the pair cannot be solved",
                  "Take more captures like it, so that the result does not hang on a single one.");
    blocks.push_back({capture, *d});
  }
  return blocks;
}

// A constant that was given with a sigma: the problem and start with it moved by `steps` sigma.
struct GivenConstant {
  std::string name;  // constants of one name are one contribution
  std::function<Solved(const Solved&, double steps)> Moved;
};

Solved WithSquare(const Solved& solved, double scale) {
  Solved moved = solved;
  for (Eigen::Vector3d& corner : moved.joint.corners_board) corner *= scale;
  for (Se3& T_a_board : moved.state.T_a_board) T_a_board.p_m *= scale;
  moved.state.T_a_b.p_m *= scale;
  return moved;
}

void AddIntrinsics(const Sensor& camera, IntrinsicsVector JointState::*intrinsics,
                   std::vector<GivenConstant>& constants) {
  if (!camera.intrinsics || !camera.intrinsics_sigma || camera.intrinsics_sigma->size() != kIntrinsicsCount) return;
  for (int i = 0; i < kIntrinsicsCount; ++i) {
    const double sigma = (*camera.intrinsics_sigma)[static_cast<std::size_t>(i)];
    if (!(sigma > 0)) continue;
    constants.push_back({"intrinsics of " + camera.id.str(), [=](const Solved& solved, double steps) {
                           Solved moved = solved;
                           (moved.state.*intrinsics)[i] += steps * sigma;
                           return moved;
                         }});
  }
}

std::vector<GivenConstant> ConstantsOf(const StereoProblem& problem) {
  std::vector<GivenConstant> constants;
  const double ratio = problem.board.square_sigma_m / problem.board.square_m;
  if (ratio > 0)
    constants.push_back({"size of board " + problem.board.id.str(), [ratio](const Solved& solved, double steps) {
                           return WithSquare(solved, 1 + steps * ratio);
                         }});
  AddIntrinsics(problem.camera_a, &JointState::intrinsics_a, constants);
  AddIntrinsics(problem.camera_b, &JointState::intrinsics_b, constants);
  return constants;
}

// (dT/dtheta) sigma by central difference over one sigma either way.
Result<Vector6d> Sensitivity(const Solved& solved, const GivenConstant& constant) {
  const Solved plus = constant.Moved(solved, 1), minus = constant.Moved(solved, -1);
  RIGCAL_ASSIGN(const JointSolution at_plus, SolveJoint(plus.joint, plus.state));
  RIGCAL_ASSIGN(const JointSolution at_minus, SolveJoint(minus.joint, minus.state));
  return Vector6d(0.5 * (at_minus.state.T_a_b.Inverse() * at_plus.state.T_a_b).Log());
}

Result<std::vector<Contribution>> ContributionsOf(const StereoProblem& problem, const Solved& solved) {
  const std::vector<GivenConstant> constants = ConstantsOf(problem);
  std::vector<std::optional<Result<Vector6d>>> shifts(constants.size());
  ParallelFor(shifts.size(), [&](std::size_t i) { shifts[i] = Sensitivity(solved, constants[i]); });
  std::vector<Contribution> contributions;
  for (std::size_t i = 0; i < constants.size(); ++i) {
    if (!*shifts[i]) return Fail(shifts[i]->error());
    if (contributions.empty() || contributions.back().name != constants[i].name)
      contributions.push_back({constants[i].name, Matrix6d::Zero()});
    contributions.back().covariance += **shifts[i] * (*shifts[i])->transpose();
  }
  return contributions;
}

std::vector<Vector6d> VectorsOf(const std::vector<BlockVector>& blocks) {
  std::vector<Vector6d> d;
  for (const BlockVector& block : blocks) d.push_back(block.d);
  return d;
}

}  // namespace

Result<Uncertainty> Jackknife(const StereoProblem& problem, const StereoEstimate& estimate) {
  const Solved solved = SolvedOf(problem, estimate);
  const std::size_t both = CountBoth(problem, solved.used);
  RIGCAL_ASSIGN(const std::vector<Contribution> contributions, ContributionsOf(problem, solved));
  std::vector<BlockVector> blocks;
  Matrix6d C = estimate.C_model;
  const bool by_jackknife = both >= kCapturesForJackknife;
  if (by_jackknife) {
    RIGCAL_ASSIGN(blocks, LeaveOneOut(problem, solved));
    // m counts the captures that carry T_a_b: single views are blocks too, but no degrees of freedom of the pair.
    C = ShrinkTowardsModel(JackknifeCovariance(VectorsOf(blocks)), estimate.C_model, static_cast<int>(both));
  }
  for (const Contribution& contribution : contributions) C += contribution.covariance;
  // Also for the model: its thousands of residuals are not independent, the captures are.
  const int dof = static_cast<int>(both) - 1;
  const auto source = by_jackknife ? UncertaintySource::kJackknife : UncertaintySource::kModel;
  RIGCAL_ASSIGN(Uncertainty uncertainty, FromCovariance(C, source, dof));
  uncertainty.blocks = std::move(blocks);
  uncertainty.contributions = contributions;
  return uncertainty;
}

}  // namespace rigcal::calib
