// The optimum of a session by Ceres and by our own Levenberg-Marquardt, from one start, with the same noise, weights,
// losses and derivatives of one corner: cameras and tracker of the virtual MARS Mapper at feature level.
// joint_peer SEEDS [CAPTURES] prints one JSON object: what each takes, and how far apart they end, in sigmas.
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "server/calib/core/pose_block.h"
#include "server/calib/joint/problem/observation.h"
#include "server/calib/joint/refine/refine.h"
#include "tests/bench/rig/joint_session.h"
#include "tests/bench/rig/rig_coverage.h"

namespace rigcal {
namespace {

using calib::BlockOf;
using calib::kIntrinsicsMax;
using calib::kPoseSize;
using calib::MinusJacobian;
using calib::PoseOf;
using namespace calib::joint;

constexpr double kKnee = 3.5;

template <int kRows>
void Write(const Eigen::Matrix<double, kRows, 6>& by_tangent, const Se3& T, double* jacobian) {
  Eigen::Map<Eigen::Matrix<double, kRows, kPoseSize, Eigen::RowMajor>> rows(jacobian);
  rows = by_tangent * MinusJacobian(T);
}

// (projected - seen) / sigma by the poses of sensor, place and board, and by the lens.
class CornerCost final : public ceres::SizedCostFunction<2, kPoseSize, kPoseSize, kPoseSize, kIntrinsicsMax> {
 public:
  CornerCost(CameraModel model, Eigen::Vector3d p_board, Eigen::Vector2d uv_px, double sigma_px)
      : model_(model), p_board_(std::move(p_board)), uv_px_(std::move(uv_px)), sigma_px_(sigma_px) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Se3 sensor = PoseOf(blocks[0]), place = PoseOf(blocks[1]), board = PoseOf(blocks[2]);
    const Se3 T_ref_board = place.Inverse() * board, T_cam_board = sensor.Inverse() * T_ref_board;
    const calib::IntrinsicsVector lens = Eigen::Map<const calib::IntrinsicsVector>(blocks[3]);
    const calib::Projection seen = calib::Project(model_, lens, T_cam_board * p_board_, jacobians != nullptr);
    if (!seen.in_front) return false;
    Eigen::Map<Eigen::Vector2d>{residuals} = (seen.uv_px - uv_px_) / sigma_px_;
    if (jacobians == nullptr) return true;
    Eigen::Matrix<double, 3, 6> moved;
    moved << Eigen::Matrix3d::Identity(), -Hat(p_board_);
    const Eigen::Matrix<double, 2, 6> by_own = seen.d_point * T_cam_board.R() * moved / sigma_px_;
    if (jacobians[0]) Write<2>(-by_own * Adjoint(T_cam_board.Inverse()), sensor, jacobians[0]);
    if (jacobians[1]) Write<2>(-by_own * Adjoint(T_ref_board.Inverse()), place, jacobians[1]);
    if (jacobians[2]) Write<2>(by_own, board, jacobians[2]);
    if (jacobians[3]) Eigen::Map<calib::IntrinsicsJacobian>{jacobians[3]} = seen.d_intrinsics / sigma_px_;
    return true;
  }

 private:
  CameraModel model_;
  Eigen::Vector3d p_board_;
  Eigen::Vector2d uv_px_;
  double sigma_px_;
};

// Log(T_told^-1 T_world_ref T_ref_body) in sigmas.
class PoseCost final : public ceres::SizedCostFunction<6, kPoseSize, kPoseSize> {
 public:
  PoseCost(Se3 T_told, Vector6d scale) : T_told_(std::move(T_told)), scale_(std::move(scale)) {}

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const Se3 place = PoseOf(blocks[0]), body = PoseOf(blocks[1]);
    const Vector6d e = (T_told_.Inverse() * place * body).Log();
    Eigen::Map<Vector6d>{residuals} = scale_.cwiseProduct(e);
    if (jacobians == nullptr) return true;
    const Matrix6d by_body = scale_.asDiagonal() * RightJacobianInverse(e);
    if (jacobians[0]) Write<6>(by_body * Adjoint(body.Inverse()), place, jacobians[0]);
    if (jacobians[1]) Write<6>(by_body, body, jacobians[1]);
    return true;
  }

 private:
  Se3 T_told_;
  Vector6d scale_;
};

class Peer {
 public:
  Peer(const SessionProblem& problem, const SessionState& start) : problem_(problem), state_(start) {
    for (const Se3& T : start.T_ref_sensor) sensors_.push_back(BlockOf(T));
    for (const Se3& T : start.T_world_ref) places_.push_back(BlockOf(T));
    for (const Se3& T : start.T_world_board) boards_.push_back(BlockOf(T));
    lenses_ = start.intrinsics;
  }

  void Build(const std::vector<SensorNoise>& noise, const LookWeights& weights) {
    for (std::size_t i = 0; i < problem_.corners.size(); ++i) AddCorners(i, noise, weights.OfCorners(i));
    for (std::size_t i = 0; i < problem_.poses.size(); ++i) AddPose(problem_.poses[i], noise, weights.poses[i]);
    for (auto* blocks : {&sensors_, &places_, &boards_})
      for (calib::PoseBlock& block : *blocks)
        if (ceres_.HasParameterBlock(block.data()))
          ceres_.SetManifold(block.data(), calib::MakeSe3Manifold().release());
    ceres_.SetParameterBlockConstant(sensors_[static_cast<std::size_t>(problem_.reference)].data());
    if (problem_.held_board != kNone)
      ceres_.SetParameterBlockConstant(boards_[static_cast<std::size_t>(problem_.held_board)].data());
    for (std::size_t c = 0; c < lenses_.size(); ++c) HoldLens(c);
  }

  ceres::Solver::Summary Solve(ceres::LinearSolverType solver) {
    ceres::Solver::Options options;
    options.num_threads = static_cast<int>(Processors());
    options.linear_solver_type = solver;
    options.logging_type = ceres::SILENT;
    options.max_num_iterations = 100;
    options.initial_trust_region_radius = 1e6;
    // As ours: until a step is expected to gain less than 1e-8 of a squared sigma.
    options.function_tolerance = 1e-13;
    options.parameter_tolerance = options.gradient_tolerance = 0;
    auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    std::vector<double*> blocks;
    ceres_.GetParameterBlocks(&blocks);
    for (double* block : blocks) ordering->AddElementToGroup(block, IsPlace(block) ? 0 : 1);
    options.linear_solver_ordering = ordering;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_, &summary);
    return summary;
  }

  [[nodiscard]] Se3 T_ref_sensor(std::size_t sensor) const { return PoseOf(sensors_[sensor].data()).Normalized(); }

 private:
  static std::size_t Processors() { return std::max<std::size_t>(1, std::thread::hardware_concurrency()); }

  [[nodiscard]] bool IsPlace(const double* block) const {
    return std::any_of(places_.begin(), places_.end(),
                       [&](const calib::PoseBlock& one) { return one.data() == block; });
  }

  void AddCorners(std::size_t i, const std::vector<SensorNoise>& noise, double weight) {
    const CornersSeen& seen = problem_.corners[i];
    const auto sensor = static_cast<std::size_t>(seen.sensor), camera = static_cast<std::size_t>(seen.camera);
    for (std::size_t k = 0; k < seen.corners.size(); ++k) {
      const auto& points = problem_.target_points[static_cast<std::size_t>(seen.target)];
      auto cost = std::make_unique<CornerCost>(problem_.cameras[camera].model,
                                               points[static_cast<std::size_t>(seen.corners.idx[k])],
                                               seen.corners.uv_px[k], noise[sensor].sigma);
      auto loss = std::make_unique<ceres::ScaledLoss>(new ceres::HuberLoss(kKnee), weight, ceres::TAKE_OWNERSHIP);
      ceres_.AddResidualBlock(cost.release(), loss.release(), sensors_[sensor].data(),
                              places_[static_cast<std::size_t>(seen.place)].data(),
                              boards_[static_cast<std::size_t>(seen.board)].data(), lenses_[camera].data());
    }
  }

  void AddPose(const PoseTold& told, const std::vector<SensorNoise>& noise, double weight) {
    const SensorNoise& own = noise[static_cast<std::size_t>(told.sensor)];
    const Vector6d scale = EachAxis(1 / own.sigma, 1 / own.sigma_rad);
    auto loss = std::make_unique<ceres::ScaledLoss>(nullptr, weight, ceres::TAKE_OWNERSHIP);
    ceres_.AddResidualBlock(std::make_unique<PoseCost>(T_world_body(state_, told), scale).release(), loss.release(),
                            places_[static_cast<std::size_t>(told.place)].data(),
                            sensors_[static_cast<std::size_t>(told.sensor)].data());
  }

  void HoldLens(std::size_t c) {
    const Lens& lens = problem_.cameras[c];
    if (!ceres_.HasParameterBlock(lenses_[c].data())) return;
    std::vector<int> held;
    for (int i = 0; i < kIntrinsicsMax; ++i)
      if (std::find(lens.refined.begin(), lens.refined.end(), i) == lens.refined.end()) held.push_back(i);
    if (lens.refined.empty()) return ceres_.SetParameterBlockConstant(lenses_[c].data());
    ceres_.SetManifold(lenses_[c].data(), std::make_unique<ceres::SubsetManifold>(kIntrinsicsMax, held).release());
  }

  const SessionProblem& problem_;
  SessionState state_;
  std::vector<calib::PoseBlock> sensors_, places_, boards_;
  std::vector<calib::IntrinsicsVector> lenses_;
  ceres::Problem ceres_;
};

double Seconds(std::chrono::steady_clock::time_point since) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

struct Result {
  double ours_s = 0, dense_s = 0, sparse_s = 0, build_s = 0, apart_sigmas = 0;
  int ours_steps = 0, peer_steps = 0;
};

// The furthest of any sensor.
double ApartSigmas(const SessionProblem& problem, const Refined& refined, const SessionState& ours, const Peer& peer) {
  double furthest = 0;
  for (std::size_t s = 0; s < problem.sensors.size(); ++s) {
    const int at = refined.layout.pose[s];
    if (at >= refined.layout.size) continue;
    const Vector6d apart = (ours.T_ref_sensor[s].Inverse() * peer.T_ref_sensor(s)).Log();
    const Matrix6d C = refined.covariance.block<6, 6>(at, at);
    furthest = std::max(furthest, std::sqrt(apart.dot(C.ldlt().solve(apart))));
  }
  return furthest;
}

// False, with the reason on stderr: it could not start.
bool Compare(const sim::Options& options, Result& result) {
  const FeatureSession session = RecordFeatures(MarsMapper(options), 0);
  SessionViews views = ViewsOf(session, NominalPoses(session));
  views.lidars.clear();
  const auto start = StartOf(views);
  if (!start) return std::fprintf(stderr, "%s\n", Sentence(start.error()).c_str()), false;
  const CaptureGroups groups = GroupsOf(start->problem, start->state);
  const auto refined = Refine(start->problem, start->state, start->noise, groups);
  if (!refined) return std::fprintf(stderr, "%s\n", Sentence(refined.error()).c_str()), false;
  const Linearization of{start->problem, refined->layout, refined->noise, refined->weights, groups};
  SessionState ours = start->state;
  auto since = std::chrono::steady_clock::now();
  const auto minimum = Minimize(of, ours);
  result.ours_s += Seconds(since);
  if (!minimum || !minimum->settled) return std::fprintf(stderr, "no minimum\n"), false;
  result.ours_steps += minimum->iterations;
  for (const auto& [solver, seconds] :
       {std::pair{ceres::DENSE_SCHUR, &result.dense_s}, {ceres::SPARSE_SCHUR, &result.sparse_s}}) {
    Peer peer(start->problem, start->state);
    since = std::chrono::steady_clock::now();
    peer.Build(refined->noise, refined->weights);
    result.build_s += Seconds(since) / 2;
    since = std::chrono::steady_clock::now();
    const auto summary = peer.Solve(solver);
    *seconds += Seconds(since);
    if (solver == ceres::DENSE_SCHUR) result.peer_steps += static_cast<int>(summary.iterations.size());
    result.apart_sigmas = std::max(result.apart_sigmas, ApartSigmas(start->problem, *refined, ours, peer));
  }
  return true;
}

int Measure(int seeds, int captures) {
  Result sum;
  for (int seed = 1; seed <= seeds; ++seed) {
    sim::Options options;
    options.seed = static_cast<std::uint64_t>(seed);
    if (captures > 0) options.captures = captures;
    options.intrinsics = sim::IntrinsicsKind::kAbsent;  // lenses are unknowns too, and nothing pulls at them
    if (!Compare(options, sum)) return 1;
  }
  const double n = seeds;
  std::printf(
      "{\"ours_s\": %.4f, \"ceres_dense_schur_s\": %.4f, \"ceres_sparse_schur_s\": %.4f, \"ceres_build_s\": %.4f, "
      "\"ours_steps\": %.1f, \"ceres_steps\": %.1f, \"apart_sigmas\": %.3g}\n",
      sum.ours_s / n, sum.dense_s / n, sum.sparse_s / n, sum.build_s / n, sum.ours_steps / n, sum.peer_steps / n,
      sum.apart_sigmas);
  return 0;
}

}  // namespace
}  // namespace rigcal

int main(int argc, char** argv) {
  return rigcal::Measure(argc > 1 ? std::atoi(argv[1]) : 3, argc > 2 ? std::atoi(argv[2]) : 0);
}
