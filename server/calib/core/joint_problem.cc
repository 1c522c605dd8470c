#include "server/calib/core/joint_problem.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <limits>

#include "server/calib/core/costs.h"
#include "server/calib/core/pose_block.h"

namespace rigcal::calib {
namespace {

// All parameters in one array, boards last: Ceres orders the blocks of a group by address, so the order, and with it
// every bit of the result, is that of the captures.
class Parameters {
 public:
  explicit Parameters(const JointState& state)
      : values_(2 * kIntrinsicsMax + kPoseSize * (1 + state.T_a_board.size())) {
    IntrinsicsAt(a()) = state.intrinsics_a;
    IntrinsicsAt(b()) = state.intrinsics_b;
    PoseAt(pair()) = BlockOf(state.T_a_b);
    for (std::size_t k = 0; k < state.T_a_board.size(); ++k) PoseAt(board(k)) = BlockOf(state.T_a_board[k]);
  }
  double* a() { return values_.data(); }
  double* b() { return a() + kIntrinsicsMax; }
  double* pair() { return b() + kIntrinsicsMax; }
  double* board(std::size_t k) { return pair() + kPoseSize * (1 + k); }

  JointState State(std::size_t boards) {
    JointState state;
    state.intrinsics_a = IntrinsicsAt(a());
    state.intrinsics_b = IntrinsicsAt(b());
    state.T_a_b = PoseOf(pair()).Normalized();
    for (std::size_t k = 0; k < boards; ++k) state.T_a_board.push_back(PoseOf(board(k)).Normalized());
    return state;
  }

 private:
  static Eigen::Map<IntrinsicsVector> IntrinsicsAt(double* block) { return Eigen::Map<IntrinsicsVector>(block); }
  static Eigen::Map<PoseBlock> PoseAt(double* block) { return Eigen::Map<PoseBlock>(block); }

  std::vector<double> values_;
};

void AddViews(const JointProblem& problem, std::size_t k, double* board, Parameters& parameters,
              ceres::Problem& ceres_problem) {
  const JointCapture& capture = problem.captures[k];
  if (!capture.a.empty())
    ceres_problem.AddResidualBlock(MakeReferenceViewCost(problem.a.model, problem.corners_board, capture.a).release(),
                                   nullptr, parameters.a(), board);
  if (!capture.b.empty())
    ceres_problem.AddResidualBlock(MakeSecondViewCost(problem.b.model, problem.corners_board, capture.b).release(),
                                   nullptr, parameters.b(), parameters.pair(), board);
  ceres_problem.SetManifold(board, MakeSe3Manifold().release());
}

void Hold(ceres::Problem& ceres_problem, double* block) {
  if (ceres_problem.HasParameterBlock(block)) ceres_problem.SetParameterBlockConstant(block);
}

void HoldSome(ceres::Problem& ceres_problem, double* block, const std::vector<int>& held) {
  if (held.empty() || !ceres_problem.HasParameterBlock(block)) return;
  auto manifold = std::make_unique<ceres::SubsetManifold>(ceres_problem.ParameterBlockSize(block), held);
  ceres_problem.SetManifold(block, manifold.release());
}

// Intrinsics that are held, held in part, or pulled to where they were given.
void SetIntrinsics(ceres::Problem& ceres_problem, double* block, const JointCamera& camera) {
  if (!ceres_problem.HasParameterBlock(block)) return;
  if (!camera.estimate) return Hold(ceres_problem, block);
  HoldSome(ceres_problem, block, camera.held);
  if (camera.pull.Pulls())
    ceres_problem.AddResidualBlock(MakeGivenIntrinsicsCost(camera.model, camera.pull).release(), nullptr, block);
}

// Ceres tells every step that its factor refused on stderr, in the middle of our log; its summary says what came of it.
void KeepCeresQuiet() { [[maybe_unused]] static const int level = FLAGS_minloglevel = google::GLOG_ERROR; }

ceres::Solver::Options Options() {
  KeepCeresQuiet();
  ceres::Solver::Options options;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-15;
  options.parameter_tolerance = 1e-13;
  options.gradient_tolerance = 1e-12;
  // Starts are near the minimum: begin with almost full Gauss-Newton steps.
  options.initial_trust_region_radius = 1e6;
  return options;
}

// A pull, however weak, closes the valley of the rational model's two halves.
bool EstimatesRational(const JointProblem& problem) {
  const auto rational = [](const JointCamera& one) {
    return one.IsFree() && one.model == CameraModel::kPinholeRational;
  };
  return rational(problem.a) || rational(problem.b);
}

tl::unexpected<Error> NotConverged(const JointProblem& problem) {
  if (EstimatesRational(problem))
    return Fail(ErrorCode::kInvalidInput,
                "the joint refinement did not converge: these views do not tell a pinhole_rational distortion",
                "Take captures with the board in all corners of the picture.");
  return Fail(
      ErrorCode::kInvalidInput, "the joint refinement did not converge",
      "Check that all pictures show this board, that those of a capture belong together, and take more captures.");
}

// The two halves of a rational distortion nearly cancel: along that valley the cost says next to nothing, so steps are
// held shorter, and what is left of it, 1e-5 sigma, does not show in the poses.
void AllowForValley(const JointProblem& problem, ceres::Solver::Options& options) {
  if (!EstimatesRational(problem)) return;
  options.initial_trust_region_radius = 1e4;
  options.function_tolerance = 1e-11;
}

void EliminateBoardsFirst(ceres::Problem& ceres_problem, Parameters& parameters, std::size_t boards,
                          ceres::Solver::Options& options) {
  options.linear_solver_type = ceres::DENSE_SCHUR;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t k = 0; k < boards; ++k) ordering->AddElementToGroup(parameters.board(k), 0);
  for (double* block : {parameters.a(), parameters.b(), parameters.pair()})
    if (ceres_problem.HasParameterBlock(block)) ordering->AddElementToGroup(block, 1);
  options.linear_solver_ordering = ordering;
}

double SumOfSquares(const ceres::CostFunction& cost, const std::vector<const double*>& blocks) {
  Eigen::VectorXd residuals(cost.num_residuals());
  if (!cost.Evaluate(blocks.data(), residuals.data(), nullptr)) return std::numeric_limits<double>::infinity();
  return residuals.squaredNorm();
}

}  // namespace

Result<JointSolution> SolveJoint(const JointProblem& problem, const JointState& start, double settled_ratio) {
  const std::size_t boards = problem.captures.size();
  Parameters parameters(start);
  ceres::Problem ceres_problem;
  for (std::size_t k = 0; k < boards; ++k) AddViews(problem, k, parameters.board(k), parameters, ceres_problem);
  if (ceres_problem.HasParameterBlock(parameters.pair()))
    ceres_problem.SetManifold(parameters.pair(), MakeSe3Manifold().release());
  SetIntrinsics(ceres_problem, parameters.a(), problem.a);
  SetIntrinsics(ceres_problem, parameters.b(), problem.b);

  ceres::Solver::Options options = Options();
  options.function_tolerance = settled_ratio;
  AllowForValley(problem, options);
  EliminateBoardsFirst(ceres_problem, parameters, boards, options);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  if (summary.termination_type != ceres::CONVERGENCE) return NotConverged(problem);
  return JointSolution{parameters.State(boards), static_cast<int>(summary.iterations.size())};
}

Se3 SolveBoardPose(const JointProblem& problem, const JointState& state, std::size_t capture_idx,
                   const Se3& T_a_board) {
  Parameters parameters({state.intrinsics_a, state.intrinsics_b, state.T_a_b, {T_a_board}});
  ceres::Problem ceres_problem;
  AddViews(problem, capture_idx, parameters.board(0), parameters, ceres_problem);
  for (double* block : {parameters.a(), parameters.b(), parameters.pair()}) Hold(ceres_problem, block);
  ceres::Solver::Options options = Options();
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = kSettledAgain_ratio;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  return PoseOf(parameters.board(0)).Normalized();
}

CaptureError ErrorOf(const JointProblem& problem, const JointState& state, std::size_t capture_idx) {
  const JointCapture& capture = problem.captures[capture_idx];
  const PoseBlock T_a_b = BlockOf(state.T_a_b), T_a_board = BlockOf(state.T_a_board[capture_idx]);
  CaptureError error;
  if (!capture.a.empty())
    error.a_px2 = SumOfSquares(*MakeReferenceViewCost(problem.a.model, problem.corners_board, capture.a),
                               {state.intrinsics_a.data(), T_a_board.data()});
  if (!capture.b.empty())
    error.b_px2 = SumOfSquares(*MakeSecondViewCost(problem.b.model, problem.corners_board, capture.b),
                               {state.intrinsics_b.data(), T_a_b.data(), T_a_board.data()});
  return error;
}

double SumOfSquares_px2(const JointProblem& problem, const JointState& state) {
  double ssr_px2 = 0;
  for (std::size_t k = 0; k < problem.captures.size(); ++k) {
    const CaptureError error = ErrorOf(problem, state, k);
    ssr_px2 += error.a_px2 + error.b_px2;
  }
  return ssr_px2;
}

int ResidualCount(const JointProblem& problem) {
  std::size_t corners = 0;
  for (const JointCapture& capture : problem.captures) corners += capture.a.size() + capture.b.size();
  return static_cast<int>(2 * corners);
}

int ParameterCount(const JointProblem& problem) {
  const int a = problem.a.IsFree() ? IntrinsicsCount(problem.a.model) : 0;
  const int b = problem.b.IsFree() ? IntrinsicsCount(problem.b.model) : 0;
  const bool pair = std::any_of(problem.captures.begin(), problem.captures.end(),
                                [](const JointCapture& capture) { return !capture.b.empty(); });
  return (pair ? 6 : 0) + a + b + 6 * static_cast<int>(problem.captures.size());
}

}  // namespace rigcal::calib
