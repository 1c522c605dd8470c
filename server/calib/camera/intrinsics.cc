#include "server/calib/camera/intrinsics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/base/process/out_of_memory.h"
#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/camera_start.h"
#include "server/calib/camera/lens_bounds.h"
#include "server/calib/camera/lens_choice.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/joint_covariance.h"
#include "server/calib/core/robust.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"
#include "server/calib/stereo/observability.h"

namespace rigcal::calib {
namespace {

// Another sensor will judge, so more poses are kept than the corners alone leave open (16): ten sigma.
constexpr double kAlternativeCost = 100.0;
constexpr int kPoseRoundsMax = 4;
constexpr int kPulledRounds = 2;
constexpr double kSamePose = 1e-3;

// Captures, views and board poses side by side.
struct Work {
  std::vector<CaptureId> captures;
  std::map<CaptureId, std::string> unused;
  CameraViews views;
  JointProblem joint;
  JointState state;
  std::vector<std::vector<Se3>> alternatives;

  void Drop(std::size_t k, const std::string& why) {
    unused[captures[k]] = why;
    EraseAt(k, captures, joint.captures, state.T_a_board);
  }
};

Work Collected(const CameraProblem& problem) {
  Work work;
  work.views = ViewsOf(problem);
  for (const auto& [capture, view] : problem.views) {
    if (std::string why = WhyUnusable(view, problem.board); !why.empty())
      work.unused[capture] = std::move(why);
    else
      work.captures.push_back(capture);
  }
  work.joint = OneCamera(work.views, !problem.camera.intrinsics);
  return work;
}

std::size_t NeededViews(const CameraProblem& problem) { return problem.camera.intrinsics ? 1 : kCapturesMin; }

OrDiagnosis<void> CheckCount(const CameraProblem& problem, const Work& work) {
  if (work.captures.size() >= NeededViews(problem)) return {};
  const std::string why = work.unused.empty() ? "" : work.unused.begin()->second;
  return tl::unexpected(TooFewViews(problem, work.captures.size(), NeededViews(problem), why));
}

OrDiagnosis<void> CheckSizes(const CameraProblem& problem) {
  const auto resized = Resized(problem, [](const BoardView& view) { return view.found; });
  if (resized.empty()) return {};
  return tl::unexpected(ImageSizeChanged(problem.camera.id, resized));
}

OrDiagnosis<IntrinsicsVector> StartOf(const CameraProblem& problem, const CameraViews& views) {
  const SensorId& camera = problem.camera.id;
  if (problem.camera.intrinsics) {
    const IntrinsicsVector given = VectorOf(*problem.camera.intrinsics);
    if (auto absurd = WhyAbsurd(problem.camera, given, views)) return tl::unexpected(std::move(*absurd));
    return given;
  }
  if (auto no_tilt = WhyNoTilt(camera, views)) return tl::unexpected(std::move(*no_tilt));
  const auto start = StartIntrinsics(views);
  if (!start) return tl::unexpected(AsDiagnosis(camera.str(), "no_intrinsics", start.error()));
  return *start;
}

double RmsOf(const Work& work, std::size_t k) {
  return std::sqrt(ErrorOf(work.joint, work.state, k).a_px2 / static_cast<double>(work.joint.captures[k].a.size()));
}

// Sets the board poses and drops the views that no pose explains.
void PlaceBoards(Work& work) {
  work.state.T_a_board.resize(work.captures.size());
  std::vector<double> rms_px;
  for (std::size_t k = 0; k < work.captures.size(); ++k) {
    const std::vector<Se3> allowed = AllowedPoses(work.joint, work.state, k);
    work.state.T_a_board[k] = ChoosePose(work.joint, work.state, k, allowed).T_a_board;
    rms_px.push_back(allowed.empty() ? std::numeric_limits<double>::infinity() : RmsOf(work, k));
  }
  const double limit_px = ContradictingRms_px(rms_px, work.views.width_px);
  for (std::size_t k = work.captures.size(); k-- > 0;)
    if (!(rms_px[k] <= limit_px && std::isfinite(rms_px[k]))) work.Drop(k, "no pose of the board explains its corners");
}

double VarianceOf(const Work& work) {
  return SumOfSquares_px2(work.joint, work.state) / std::max(1, ResidualCount(work.joint) - ParameterCount(work.joint));
}

OrDiagnosis<void> Solve(const CameraProblem& problem, Work& work) {
  auto solution = SolveJoint(work.joint, work.state);
  if (!solution) return tl::unexpected(AsDiagnosis(problem.camera.id.str(), "no_convergence", solution.error()));
  work.state = std::move(solution->state);
  return {};
}

OrDiagnosis<void> Refine(const CameraProblem& problem, Work& work) {
  if (!problem.camera.intrinsics) return Solve(problem, work);
  for (std::size_t k = 0; k < work.captures.size(); ++k)
    work.state.T_a_board[k] = SolveBoardPose(work.joint, work.state, k, work.state.T_a_board[k]);
  return {};
}

// Frees intrinsics that were given with sigmas. What the corners are good for is known once they fit.
OrDiagnosis<void> RefineWithin(const CameraProblem& problem, double corner_sigma_px, Work& work) {
  work.joint.a.estimate = true;
  work.joint.a.held = HeldOf(problem.camera);
  work.joint.a.pull = PullOf(problem.camera, corner_sigma_px);
  return Solve(problem, work);
}

// One look at every board's other pose: kept as an alternative, or taken. Returns whether anything changed.
bool ReconsiderBoards(Work& work) {
  const double variance_px2 = VarianceOf(work);
  bool changed = false;
  work.alternatives.assign(work.captures.size(), {});
  for (std::size_t k = 0; k < work.captures.size(); ++k) {
    std::vector<Se3> candidates = AllowedPoses(work.joint, work.state, k);
    candidates.insert(candidates.begin(), work.state.T_a_board[k]);
    const PoseChoice choice = ChoosePose(work.joint, work.state, k, candidates);
    if (choice.other_ssr_px2 - choice.ssr_px2 < kAlternativeCost * variance_px2)
      work.alternatives[k] = {choice.T_a_board_other};
    changed |= (work.state.T_a_board[k].Inverse() * choice.T_a_board).Log().norm() > kSamePose;
    work.state.T_a_board[k] = choice.T_a_board;
  }
  return changed;
}

OrDiagnosis<void> RefineGiven(const CameraProblem& problem, Work& work) {
  if (!RefinesIntrinsics(problem.camera)) return {};
  for (int round = 0; round < kPoseRoundsMax; ++round) {
    for (int again = 0; again < kPulledRounds; ++again)
      if (auto refined = RefineWithin(problem, std::sqrt(VarianceOf(work)), work); !refined) return refined;
    if (!ReconsiderBoards(work)) break;
  }
  return {};
}

OrDiagnosis<Work> FromScratch(const CameraProblem& problem) {
  Work work = Collected(problem);
  if (auto enough = CheckCount(problem, work); !enough) return tl::unexpected(enough.error());
  if (auto sizes = CheckSizes(problem); !sizes) return tl::unexpected(sizes.error());
  RIGCAL_ASSIGN(const auto start, StartOf(problem, work.views));
  work.state.intrinsics_a = start;
  PlaceBoards(work);
  if (auto enough = CheckCount(problem, work); !enough) return tl::unexpected(enough.error());
  for (int round = 0; round < kPoseRoundsMax; ++round) {
    if (auto refined = Refine(problem, work); !refined) return tl::unexpected(refined.error());
    if (!ReconsiderBoards(work)) break;
  }
  if (auto refined = RefineGiven(problem, work); !refined) return tl::unexpected(refined.error());
  return work;
}

OrDiagnosis<Work> FromStart(const CameraProblem& problem, const CameraEstimate& start) {
  Work work = Collected(problem);
  work.state.intrinsics_a = VectorOf(HoldsIntrinsics(problem.camera) ? *problem.camera.intrinsics : start.intrinsics);
  work.state.T_a_board.resize(work.captures.size());
  for (std::size_t k = work.captures.size(); k-- > 0;) {
    const auto board = start.T_cam_board.find(work.captures[k]);
    if (board == start.T_cam_board.end())
      work.Drop(k, "not in the estimate that this one starts from");
    else
      work.state.T_a_board[k] = board->second;
  }
  if (auto enough = CheckCount(problem, work); !enough) return tl::unexpected(enough.error());
  const auto refined =
      start.pull.Pulls() ? RefineWithin(problem, start.pull.corner_sigma_px, work) : Refine(problem, work);
  if (!refined) return tl::unexpected(refined.error());
  for (const CaptureId& capture : work.captures) {
    const auto other = start.alternatives.find(capture);
    work.alternatives.push_back(other == start.alternatives.end() ? std::vector<Se3>() : other->second);
  }
  return work;
}

OrDiagnosis<void> CheckConditioning(const CameraProblem& problem, const Work& work) {
  if (problem.camera.intrinsics) return {};
  const auto covariance = ModelCovariance(work.joint, work.state);
  if (!covariance) return tl::unexpected(CameraIllConditioned(problem.camera.id, covariance.error().what));
  const Eigen::VectorXd variances = covariance->captures.diagonal().segment<kIntrinsicsMax>(kIntrinsicsAStart);
  if (auto open =
          WhyDistortionOpen(problem.camera.id, work.joint.a.model, variances, work.views, work.state.intrinsics_a))
    return tl::unexpected(std::move(*open));
  return {};
}

void AddOfIntrinsics(const Work& work, std::size_t k, CameraEstimate& estimate) {
  if (!work.joint.a.estimate) return;
  if (const auto moments = MomentsAt(work.joint.a.model, work.state.intrinsics_a, work.joint.corners_board,
                                     work.joint.captures[k].a, work.state.T_a_board[k]))
    estimate.of_intrinsics.emplace(work.captures[k], Eliminated(*moments));
}

OrDiagnosis<CameraEstimate> Finished(const CameraProblem& problem, const Work& work) {
  if (auto conditioned = CheckConditioning(problem, work); !conditioned) return tl::unexpected(conditioned.error());
  CameraEstimate estimate;
  estimate.intrinsics = IntrinsicsOf(work.joint.a.model, work.state.intrinsics_a);
  estimate.unused = work.unused;
  estimate.variance_px2 = VarianceOf(work);
  estimate.pull = work.joint.a.pull;
  for (std::size_t k = 0; k < work.captures.size(); ++k) {
    const CaptureId& capture = work.captures[k];
    const auto information = BoardInformation(work.joint, work.state, k);
    if (!information) return tl::unexpected(CameraIllConditioned(problem.camera.id, information.error().what));
    estimate.T_cam_board[capture] = work.state.T_a_board[k];
    estimate.information[capture] = *information;
    AddOfIntrinsics(work, k, estimate);
    if (!work.alternatives[k].empty()) estimate.alternatives[capture] = work.alternatives[k];
    estimate.rms_by_capture_px[capture] = RmsOf(work, k);
  }
  estimate.rms_px = std::sqrt(2 * SumOfSquares_px2(work.joint, work.state) / ResidualCount(work.joint));
  const double limit_px = HighRms_px(work.views.width_px);
  if (!(estimate.rms_px <= limit_px)) return tl::unexpected(CameraHighResidual(problem, estimate.rms_px, limit_px));
  return estimate;
}

CameraProblem WithModel(CameraProblem problem, CameraModel model) {
  problem.camera.intrinsics.reset();
  problem.camera.intrinsics_sigma.reset();
  problem.camera.camera_model = model;
  return problem;
}

OrDiagnosis<CameraEstimate> Estimated(const CameraProblem& problem, const CameraEstimate* start) {
  try {
    RIGCAL_ASSIGN(const auto work, start != nullptr ? FromStart(problem, *start) : FromScratch(problem));
    auto estimate = Finished(problem, work);
    if (estimate && start == nullptr && !HoldsIntrinsics(problem.camera))
      if (auto absurd = WhyAbsurd(problem.camera, work.state.intrinsics_a, work.views))
        return tl::unexpected(std::move(*absurd));
    return estimate;
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;  // not the data's fault: the caller tries again
    const Error error{ErrorCode::kInternal, exception.what(), "Report this with the session's id."};
    return tl::unexpected(AsDiagnosis(problem.camera.id.str(), "internal", error));
  }
}

}  // namespace

std::vector<Se3> CameraEstimate::PosesOf(const CaptureId& capture) const {
  std::vector<Se3> poses;
  if (const auto at = T_cam_board.find(capture); at != T_cam_board.end()) poses.push_back(at->second);
  if (const auto at = alternatives.find(capture); at != alternatives.end())
    poses.insert(poses.end(), at->second.begin(), at->second.end());
  return poses;
}

OrDiagnosis<CameraEstimate> EstimateCamera(const CameraProblem& problem, const CameraEstimate* start) {
  auto estimate = Estimated(problem, start);
  if (!estimate && start == nullptr)
    return tl::unexpected(WithLensAsCure(TiltOrLens(problem, std::move(estimate.error())), {{"", problem}}));
  return estimate;
}

OrDiagnosis<CameraEstimate> EstimateCameraAs(const CameraProblem& problem, CameraModel model) {
  return Estimated(WithModel(problem, model), nullptr);
}

double FitRms_px(const CameraProblem& problem, CameraModel model) {
  double rms_px = std::numeric_limits<double>::infinity();
  try {
    if (const auto work = FromScratch(WithModel(problem, model)))
      rms_px = std::sqrt(2 * SumOfSquares_px2(work->joint, work->state) / ResidualCount(work->joint));
  } catch (const std::exception& exception) {
    if (IsOutOfMemory(exception)) throw;
  }
  return rms_px;
}

OrDiagnosis<CameraEstimate> EstimateCameraBy(const CameraSolver& solver, const CameraProblem& problem) {
  return solver ? solver(problem) : EstimateCamera(problem);
}

}  // namespace rigcal::calib
