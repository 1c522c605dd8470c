#include "server/calib/lidar_camera/lidar_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/calib/core/robust.h"
#include "server/calib/core/selection.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_work.h"
#include "server/calib/lidar_camera/patch_choice.h"

namespace rigcal::calib {
namespace {

constexpr int kChoicesMax = 4, kRejectionsMax = 5, kReweighingsMax = 3;
constexpr double kOtherSupportRatio = 0.8;

PlaneCandidates CandidatesOf(const LidarCameraProblem& problem, const CameraEstimate& camera, std::size_t idx) {
  const LidarCameraCapture& capture = problem.captures[idx];
  PlaneCandidates candidates;
  for (const Se3& T_cam_board : camera.PosesOf(capture.capture))
    candidates.camera.push_back({-T_cam_board.R().col(2), T_cam_board * PlateCentreOf(problem.board)});
  for (const PlanePatch& patch : capture.cloud->candidates) candidates.lidar.push_back({patch.normal, patch.centre_m});
  return candidates;
}

// Makes the pose that stands at `idx` of PosesOf() the capture's; the former one becomes an alternative.
void TakePose(CameraEstimate& camera, const CaptureId& capture, std::size_t idx) {
  if (idx > 0) std::swap(camera.T_cam_board.at(capture), camera.alternatives.at(capture)[idx - 1]);
}

// A board that was left standing, or a file that was copied, is no second measurement. Empty: it is none.
std::string WhyRepeated(const LidarCameraProblem& problem, const std::vector<std::size_t>& earlier, std::size_t idx) {
  for (const std::size_t other : earlier)
    if (ShowSame(*problem.captures[other].view, *problem.captures[idx].view, problem.board))
      return "shows the same as " + problem.captures[other].capture.str();
  return {};
}

// Decides which patch is the board in each capture.
OrDiagnosis<LidarCameraWork> Choose(const LidarCameraProblem& problem, CameraEstimate camera,
                                    std::vector<Diagnosis>& notes) {
  LidarCameraWork work;
  std::vector<std::size_t> both;
  std::vector<PlaneCandidates> candidates;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    std::string why = WhyUseless(problem, camera, idx);
    if (why.empty()) why = WhyRepeated(problem, both, idx);
    if (!why.empty()) {
      work.unused[idx] = std::move(why);
      continue;
    }
    both.push_back(idx);
    candidates.push_back(CandidatesOf(problem, camera, idx));
  }
  if (both.size() < kLidarCapturesMin) return tl::unexpected(TooFewLidarCaptures(problem, both.size()));
  const auto choice = ChoosePatches(candidates, problem.T_cam_lidar_nominal);
  if (!choice || choice->supporters < kLidarCapturesMin || 2 * choice->supporters < both.size())
    return tl::unexpected(NoAgreement(problem, both.size(), choice ? choice->supporters : 0));
  if (choice->other && !choice->settled_by_nominal &&
      static_cast<double>(choice->other_supporters) >= kOtherSupportRatio * static_cast<double>(choice->supporters))
    return tl::unexpected(AmbiguousBoard(problem, choice->supporters, choice->other_supporters));
  work.T_cam_lidar = choice->T_cam_lidar;
  work.range_bias_m = problem.range_bias_m;
  std::vector<CaptureId> apart;
  for (std::size_t i = 0; i < both.size(); ++i) {
    const CaptureId& capture = problem.captures[both[i]].capture;
    if (!choice->matches[i]) {
      apart.push_back(capture);
      work.unused[both[i]] = "no patch of its cloud is where the camera sees the board";
      continue;
    }
    TakePose(camera, capture, choice->matches[i]->camera_idx);
    work.used.push_back({both[i], choice->matches[i]->lidar_idx});
  }
  if (!apart.empty()) notes.push_back(CapturesDisagree(problem, apart));
  work.camera = std::move(camera);
  return work;
}

OrDiagnosis<void> Solve(const LidarCameraProblem& problem, LidarCameraWork& work) {
  auto solution = SolvePlanes(work.planes, work.StateOf(), false);
  if (!solution) return tl::unexpected(NotSolvable(problem, solution.error()));
  work.solution = std::move(*solution);
  work.T_cam_lidar = work.solution.state.T_cam_lidar;
  return {};
}

// With a pose that fits, the patches and the two poses of a plane seen small are told apart better than at the start.
bool ChooseAgain(const LidarCameraProblem& problem, LidarCameraWork& work) {
  bool changed = false;
  for (UsedPatch& used : work.used) {
    const auto match = BestMatch(CandidatesOf(problem, work.camera, used.capture_idx), work.T_cam_lidar);
    if (!match || (match->camera_idx == 0 && match->lidar_idx == used.patch_idx)) continue;
    TakePose(work.camera, problem.captures[used.capture_idx].capture, match->camera_idx);
    used.patch_idx = match->lidar_idx;
    changed = true;
  }
  if (changed) FillPlanes(problem, work);
  return changed;
}

// Captures whose cloud and picture disagree far more than the others: the board moved between them, or it is another
// patch.
bool DropContradicting(const LidarCameraProblem& problem, LidarCameraWork& work, std::vector<CaptureId>& dropped) {
  std::vector<double> distances_m, angles_rad;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const LidarCameraCheck check = CheckOf(problem, work, k);
    distances_m.push_back(std::abs(check.distance_m));
    angles_rad.push_back(check.angle_rad);
  }
  const BoardGate gate(distances_m, angles_rad);
  bool any = false;
  for (std::size_t k = work.used.size(); k-- > 0;) {
    if (gate.Passes(distances_m[k], angles_rad[k])) continue;
    dropped.push_back(problem.captures[work.used[k].capture_idx].capture);
    work.Drop(k, "its cloud contradicts its picture by " + MillimetresText(distances_m[k]) + " and " +
                     DegreesText(angles_rad[k]));
    any = true;
  }
  return any;
}

// Boards whose normals lie in one plane, as those of a robot that turns on a flat floor, tell five of six numbers.
OrDiagnosis<void> ConstrainUnobservable(const LidarCameraProblem& problem, LidarCameraWork& work) {
  const NormalSpread spread = SpreadOf(work.planes);
  work.held.reset();
  if (spread.sigma_m <= kNormalSigmaMax_m) return {};
  if (spread.next_sigma_m > kNormalSigmaGood_m)
    return tl::unexpected(NoNormalSpread(problem, spread.cone_deg, spread.sigma_m));
  const Se3& drawn = problem.T_cam_lidar_nominal ? *problem.T_cam_lidar_nominal : work.T_cam_lidar;
  work.held = HeldDirection{spread.axis_cam, spread.axis_cam.dot(drawn.p_m)};
  return {};
}

OrDiagnosis<void> Refine(const LidarCameraProblem& problem, LidarCameraWork& work, std::vector<Diagnosis>& notes) {
  std::vector<CaptureId> dropped;
  for (int round = 0; round < kChoicesMax; ++round) {
    if (auto solved = Solve(problem, work); !solved) return solved;
    if (!ChooseAgain(problem, work)) break;
  }
  for (int round = 0; round < kRejectionsMax; ++round) {
    if (auto solved = Solve(problem, work); !solved) return solved;
    if (!DropContradicting(problem, work, dropped)) break;
    std::sort(dropped.begin(), dropped.end());
    if (work.used.size() < kLidarCapturesMin) return tl::unexpected(ContradictingClouds(problem, dropped));
  }
  if (!dropped.empty()) notes.push_back(ContradictingClouds(problem, dropped));
  for (int round = 0; round < kReweighingsMax; ++round) {
    Reweigh(problem, work);
    if (auto solved = Solve(problem, work); !solved) return solved;
  }
  return {};
}

// The directions count as the normals lie in the end: until then a pose of a board may be the wrong one of two.
OrDiagnosis<void> RefineTold(const LidarCameraProblem& problem, LidarCameraWork& work, std::vector<Diagnosis>& notes) {
  if (auto spread = ConstrainUnobservable(problem, work); !spread) return spread;
  if (auto refined = Refine(problem, work, notes); !refined) return refined;
  const bool held = work.held.has_value();
  if (auto spread = ConstrainUnobservable(problem, work); !spread) return spread;
  return held || work.held ? Refine(problem, work, notes) : OrDiagnosis<void>();
}

// Chi-square per degree of freedom: three numbers of each capture's plane against the pose.
double VarianceFactor(const LidarCameraWork& work) {
  double chi2 = 0;
  for (std::size_t k = 0; k < work.planes.size(); ++k) {
    const PlaneCapture& plane = work.planes[k];
    const Vector7d g = PlaneInLidar(work.solution.state, k);
    const Vector6d delta = (plane.T_cam_board.Inverse() * work.solution.state.T_cam_board[k]).Log();
    chi2 += plane.factor * std::max(0.0, g.dot(plane.moments.sum * g) - LeastSquares(plane.moments)) +
            delta.dot(plane.camera_information * delta);
  }
  return chi2 / (3.0 * static_cast<double>(work.planes.size()) - 6.0);
}

void FillResiduals(const LidarCameraProblem& problem, const LidarCameraWork& work, LidarCameraEstimate& estimate) {
  double sum_m2 = 0, sum_rad2 = 0;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const CaptureId& capture = problem.captures[work.used[k].capture_idx].capture;
    const LidarCameraCheck check = CheckOf(problem, work, k);
    estimate.patch_idx[capture] = work.used[k].patch_idx;
    estimate.moments[capture] = work.planes[k].moments;
    estimate.checks[capture] = check;
    sum_m2 += check.distance_m * check.distance_m;
    sum_rad2 += check.angle_rad * check.angle_rad;
  }
  const double count = static_cast<double>(work.used.size());
  estimate.rms_m = std::sqrt(sum_m2 / count);
  estimate.rms_rad = std::sqrt(sum_rad2 / count);
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const CaptureId& capture = problem.captures[idx].capture;
    const auto check = estimate.checks.find(capture);
    if (check != estimate.checks.end())
      estimate.residuals.push_back({capture, std::abs(check->second.distance_m), true, {}});
    else
      estimate.residuals.push_back({capture, 0.0, false, work.unused.at(idx)});
  }
}

LidarCameraEstimate Finished(const LidarCameraProblem& problem, const LidarCameraWork& work) {
  LidarCameraEstimate estimate;
  estimate.T_cam_lidar = work.T_cam_lidar;
  estimate.camera = work.camera;
  estimate.held = work.held;
  estimate.range_sigma_m = work.range_sigma_m;
  estimate.capture_sigma_m = work.capture_sigma_m;
  // Never better than the noise that was put in: a few captures may fit by luck.
  const double variance_factor = std::max(1.0, VarianceFactor(work));
  const Matrix6d information = work.solution.information.topLeftCorner<6, 6>();
  estimate.C_model = Symmetrized(variance_factor * information.inverse());
  if (work.held) estimate.untold = FollowingHeld(work.solution).normalized();
  FillResiduals(problem, work, estimate);
  return estimate;
}

}  // namespace

CameraProblem CameraOf(const LidarCameraProblem& problem) {
  CameraProblem camera{problem.camera, problem.board, {}};
  for (const LidarCameraCapture& capture : problem.captures)
    if (capture.view) camera.views.emplace_back(capture.capture, *capture.view);
  return camera;
}

bool LidarCameraEstimate::SuspectsBoardSize() const {
  return scale_fits_better && std::abs(board_scale_ratio) > kScaleMin_ratio &&
         std::abs(board_scale_ratio) > kBiasSigmas * board_scale_sigma_ratio;
}

bool LidarCameraEstimate::SuspectsRangeBias() const {
  return !SuspectsBoardSize() && std::abs(range_bias_m) > kBiasMin_m &&
         std::abs(range_bias_m) > kBiasSigmas * range_bias_sigma_m;
}

OrDiagnosis<LidarCameraEstimate> EstimateLidarCamera(const LidarCameraProblem& problem,
                                                     const LidarCameraEstimate* start, std::vector<Diagnosis>* notes) {
  std::vector<Diagnosis> ignored;
  if (start != nullptr) {
    LidarCameraWork work = WorkOf(problem, *start);
    if (auto solved = Solve(problem, work); !solved) return tl::unexpected(solved.error());
    return Finished(problem, work);
  }
  auto camera = EstimateCameraBy(problem.solve_camera, CameraOf(problem));
  if (!camera) return tl::unexpected(OfSide(std::move(camera.error()), SideOfCamera(problem)));
  if (!problem.camera.intrinsics && camera->T_cam_board.size() < kLidarViewsForIntrinsics)
    return tl::unexpected(TooFewForIntrinsics(problem, camera->T_cam_board.size()));
  std::vector<Diagnosis>& kept = notes != nullptr ? *notes : ignored;
  RIGCAL_ASSIGN(auto work, Choose(problem, std::move(*camera), kept));
  FillPlanes(problem, work);
  RIGCAL_TRY(RefineTold(problem, work, kept));
  LidarCameraEstimate estimate = Finished(problem, work);
  EstimateSystematics(problem, work, estimate);
  return estimate;
}

}  // namespace rigcal::calib
