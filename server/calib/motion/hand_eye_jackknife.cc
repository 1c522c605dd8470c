#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>

#include "server/calib/core/leave_one_out.h"
#include "server/calib/motion/hand_eye_work.h"

namespace rigcal::calib {
namespace {

// From the optimum of a problem that differs little.
constexpr MotionStop kAgain{.linear_ratio = kLinearAgain_ratio};

// What is left out together: poses of the problem, and views of these captures, which tell a camera's intrinsics.
struct Block {
  std::string id;
  std::vector<std::size_t> poses;
  std::set<CaptureId> captures;
};

// Captures with a view that only tells a camera's intrinsics.
std::set<CaptureId> SingleViews(const HandEyeWork& work) {
  std::set<CaptureId> singles;
  for (const auto* camera : {&work.camera_a, &work.camera_b}) {
    if (!*camera || !(*camera)->estimates_intrinsics) continue;
    for (const auto& [capture, views] : (*camera)->views) singles.insert(capture);
  }
  for (const CaptureId& capture : work.captures) singles.erase(capture);
  return singles;
}

// Parts of a stream.
std::vector<Block> PartsOf(const HandEyeWork& work, const std::vector<std::size_t>& block_of_pose) {
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < work.captures.size(); ++k) {
    if (blocks.size() <= block_of_pose[k]) blocks.push_back({"part " + std::to_string(blocks.size() + 1), {}, {}});
    blocks[block_of_pose[k]].poses.push_back(k);
  }
  return blocks;
}

std::vector<Block> BlocksOf(const HandEyeProblem& problem, const HandEyeWork& work) {
  std::set<CaptureId> used = SingleViews(work);
  for (std::size_t k = 0; k < work.captures.size(); ++k)
    if (work.problem.used[k]) used.insert(work.captures[k]);
  std::vector<Block> blocks;
  for (CaptureBlock& one : CaptureBlocks(problem.session_captures, used)) {
    Block block{std::move(one.id), {}, std::move(one.captures)};
    for (std::size_t k = 0; k < work.captures.size(); ++k)
      if (work.problem.used[k] && block.captures.contains(work.captures[k])) block.poses.push_back(k);
    blocks.push_back(std::move(block));
  }
  return blocks;
}

std::size_t CarryingBlocks(const std::vector<Block>& blocks) {
  return static_cast<std::size_t>(
      std::count_if(blocks.begin(), blocks.end(), [](const Block& block) { return !block.poses.empty(); }));
}

Result<Se3> SolvedPose(const MotionProblem& problem, const MotionState& start) {
  RIGCAL_ASSIGN(const MotionSolution solution, SolveMotion(problem, start, kAgain));
  return solution.state.X;
}

// `asked`: where what is asked for beside it comes to lie.
Result<Se3> WithoutBlockOf(const HandEyeWork& work, const Block& block, double& asked) {
  MotionProblem problem = work.problem;
  for (const std::size_t k : block.poses) problem.used[k] = 0;
  if (!block.captures.empty()) SetShared(work, block.captures, problem);
  RIGCAL_ASSIGN(const MotionSolution solution, SolveMotion(problem, work.state, kAgain));
  asked = AskedOf(work, solution.state);
  return solution.state.X;
}

// The jackknife's, or the model's where it is larger.
double AskedSigma(const HandEyeWork& work, const std::vector<double>& asked) {
  if (work.asked == Asked::kNothing) return 0.0;
  const double model = work.asked == Asked::kBoardSizeA ? work.fit.last_sigma_a : work.fit.last_sigma_b;
  const auto m = static_cast<double>(asked.size());
  if (m < 2) return model;
  double mean = 0, sum = 0;
  for (const double one : asked) mean += one / m;
  for (const double one : asked) sum += (one - mean) * (one - mean);
  return std::max(std::sqrt((m - 1) / m * sum), model);
}

// A board that is larger than given puts its camera farther away.
void AddBoardSize(const HandEyeWork& work, const HandEyeSide& side, MotionSide MotionProblem::*poses,
                  std::vector<GivenConstant>& constants) {
  const auto with_size = [&work, poses](double larger_ratio) {
    MotionProblem moved = work.problem;
    for (SidePose& pose : (moved.*poses).poses) pose.T_world_sensor.p_m *= 1 + larger_ratio;
    return SolvedPose(moved, work.state);
  };
  if (side.board) AddBoardSize(*side.board, side.board->square_sigma_m / side.board->square_m, with_size, constants);
}

// A larger value given moves what pulls the shared parameter, 1/2 (s - value)^2 / sigma^2.
void AddIntrinsics(const HandEyeWork& work, const HandEyeSide& side, MotionSide MotionProblem::*poses,
                   std::vector<GivenConstant>& constants) {
  for (const int i : RefinedOf(side.sensor)) {
    const double sigma = (*side.sensor.intrinsics_sigma)[static_cast<std::size_t>(i)];
    constants.push_back({IntrinsicsName(side.sensor.id), [&work, poses, i, sigma](double steps) {
                           MotionProblem moved = work.problem;
                           (moved.*poses).gradient[i] -= steps / sigma;
                           return SolvedPose(moved, work.state);
                         }});
  }
}

// The model's covariance without what given intrinsics bring, which is a contribution of its own.
Eigen::MatrixXd CapturesPart(const HandEyeProblem& problem, const HandEyeWork& work,
                             const std::vector<Contribution>& contributions) {
  const auto& free = work.problem.free;
  Eigen::MatrixXd part = work.fit.C_X;
  for (const Contribution& given : contributions)
    if (given.name == IntrinsicsName(problem.a.sensor.id) || given.name == IntrinsicsName(problem.b.sensor.id))
      part -= free.transpose() * given.covariance * free;
  return Eigen::LLT<Eigen::MatrixXd>(part).info() == Eigen::Success ? part : work.fit.C_X;
}

}  // namespace

Result<MotionUncertainty> JackknifeMotion(const HandEyeProblem& problem, const HandEyeWork& work,
                                          const std::vector<std::size_t>& block_of_pose) {
  std::vector<GivenConstant> constants;
  AddBoardSize(work, problem.a, &MotionProblem::a, constants);
  AddBoardSize(work, problem.b, &MotionProblem::b, constants);
  AddIntrinsics(work, problem.a, &MotionProblem::a, constants);
  AddIntrinsics(work, problem.b, &MotionProblem::b, constants);
  RIGCAL_ASSIGN(std::vector<Contribution> contributions, ContributionsOf(constants));
  const std::vector<Block> blocks = block_of_pose.empty() ? BlocksOf(problem, work) : PartsOf(work, block_of_pose);
  const std::size_t carrying = CarryingBlocks(blocks);
  std::vector<BlockVector> vectors;
  std::vector<double> asked;
  if (carrying >= kHandEyeForJackknife) {
    std::vector<std::string> ids;
    for (const Block& block : blocks) ids.push_back(block.id);
    asked.resize(blocks.size());
    const auto without = [&](std::size_t i) { return WithoutBlockOf(work, blocks[i], asked[i]); };
    RIGCAL_ASSIGN(vectors, LeaveOneOut(ids, work.state.X, without));
  }
  MotionUncertainty uncertainty{{}, AskedSigma(work, asked)};
  RIGCAL_ASSIGN(uncertainty.X, UncertaintyAlong(work.problem.free, CapturesPart(problem, work, contributions),
                                                std::move(vectors), std::move(contributions), carrying));
  return uncertainty;
}

}  // namespace rigcal::calib
