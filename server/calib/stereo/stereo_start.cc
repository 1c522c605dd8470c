#include "server/calib/stereo/stereo_start.h"

#include <algorithm>

#include "server/calib/core/diagnoses.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"
#include "server/calib/stereo/pair_start.h"

namespace rigcal::calib {
namespace {

OrDiagnosis<IntrinsicsVector> StartOf(const StereoProblem& problem, const Sensor& camera, const CameraViews& views) {
  if (camera.intrinsics) return VectorOf(*camera.intrinsics);
  auto start = StartIntrinsics(views);
  if (start) return *start;
  Error error = start.error();
  error.what = camera.id.str() + ": " + error.what;
  return tl::unexpected(FromError(problem, "no_intrinsics", error));
}

// Of every capture that both cameras saw, with all turns of b's view.
std::vector<PoseCandidates> CandidatesOf(const StereoProblem& problem, const StereoWork& work) {
  const JointProblem& joint = work.joint;
  std::vector<PoseCandidates> candidates;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const JointCapture& capture = joint.captures[k];
    if (capture.a.empty() || capture.b.empty()) continue;
    PoseCandidates poses;
    poses.T_a_board = PlanarPoses(joint.model_a, work.state.intrinsics_a, joint.corners_board, capture.a);
    for (int turn = 0; turn < SymmetryOf(problem.board); ++turn) {
      const SeenCorners turned = SeenIn(*problem.captures[work.used[k]].b, problem.board, turn);
      for (const Se3& T_b_board : PlanarPoses(joint.model_b, work.state.intrinsics_b, joint.corners_board, turned))
        poses.T_b_board.push_back(T_b_board);
    }
    candidates.push_back(std::move(poses));
  }
  return candidates;
}

}  // namespace

OrDiagnosis<StereoStart> ColdStart(const StereoProblem& problem) {
  StereoStart start;
  StereoWork& work = start.work;
  Selection selection = Select(problem);
  work.used = std::move(selection.used);
  work.unused = std::move(selection.unused);
  if (CountBoth(problem, work.used) < kCapturesMin)
    return tl::unexpected(TooFewCaptures(problem, CountBoth(problem, work.used)));
  work.joint = JointOf(problem, work.used);
  const CameraViews views_a = ViewsOfA(problem, work.used), views_b = ViewsOfB(problem, work.used);
  const auto intrinsics_a = StartOf(problem, problem.camera_a, views_a);
  if (!intrinsics_a) return tl::unexpected(intrinsics_a.error());
  const auto intrinsics_b = StartOf(problem, problem.camera_b, views_b);
  if (!intrinsics_b) return tl::unexpected(intrinsics_b.error());
  work.state.intrinsics_a = *intrinsics_a;
  work.state.intrinsics_b = *intrinsics_b;
  const std::vector<PoseCandidates> candidates = CandidatesOf(problem, work);
  const auto T_a_b = ConsensusOf(candidates);
  if (!T_a_b) return tl::unexpected(NoCommonView(problem));
  start.T_a_b = {*T_a_b};
  const int symmetry = SymmetryOf(problem.board);
  if (symmetry > 1)
    for (const Se3& rival : RivalsOf(candidates, *T_a_b, static_cast<std::size_t>(symmetry) - 1))
      start.T_a_b.push_back(rival);
  start.width_px = std::max(views_a.width_px, views_b.width_px);
  start.distance_m = MedianDistance_m(candidates);
  return start;
}

StereoWork WarmStart(const StereoProblem& problem, const StereoEstimate& start) {
  StereoWork work;
  work.state.intrinsics_a =
      VectorOf(HoldsIntrinsics(problem.camera_a) ? *problem.camera_a.intrinsics : start.intrinsics_a);
  work.state.intrinsics_b =
      VectorOf(HoldsIntrinsics(problem.camera_b) ? *problem.camera_b.intrinsics : start.intrinsics_b);
  work.state.T_a_b = start.T_a_b;
  for (std::size_t idx = 0; idx < problem.captures.size(); ++idx) {
    const CaptureId& capture = problem.captures[idx].capture;
    const auto board = start.T_a_board.find(capture);
    if (board == start.T_a_board.end()) {
      work.unused[idx] = "not in the estimate that this one starts from";
      continue;
    }
    const auto turn = start.turn_b.find(capture);
    work.used.push_back(idx);
    work.turns_b.push_back(turn == start.turn_b.end() ? 0 : turn->second);
    work.state.T_a_board.push_back(board->second);
  }
  work.joint = JointOf(problem, work.used, start.turn_b);
  SetCornerSigma(problem, start.corner_sigma_px, work.joint);
  return work;
}

}  // namespace rigcal::calib
