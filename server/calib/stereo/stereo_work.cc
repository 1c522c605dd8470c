#include "server/calib/stereo/stereo_work.h"

#include <algorithm>
#include <cmath>

#include "server/calib/camera/lens_bounds.h"
#include "server/calib/core/capture_blocks.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/robust.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"
#include "server/calib/stereo/pair_start.h"

namespace rigcal::calib {
namespace {

OrDiagnosis<IntrinsicsVector> StartOf(const StereoProblem& problem, const Sensor& camera, const CameraViews& views) {
  if (camera.intrinsics) {
    const IntrinsicsVector given = VectorOf(*camera.intrinsics);
    if (auto absurd = WhyAbsurd(camera, given, views)) return tl::unexpected(std::move(*absurd));
    return given;
  }
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
    poses.T_a_board = PlanarPoses(joint.a.model, work.state.intrinsics_a, joint.corners_board, capture.a);
    for (int turn = 0; turn < SymmetryOf(problem.board); ++turn) {
      const SeenCorners turned = SeenIn(*problem.captures[work.used[k]].b, problem.board, turn);
      for (const Se3& T_b_board : PlanarPoses(joint.b.model, work.state.intrinsics_b, joint.corners_board, turned))
        poses.T_b_board.push_back(T_b_board);
    }
    candidates.push_back(std::move(poses));
  }
  return candidates;
}

// Two minima of a board's pose whose weighted costs differ by less than four sigma squared cannot be told apart.
constexpr double kAmbiguousCost = 16.0;
constexpr int kPoseRoundsMax = 4;
constexpr int kPulledRounds = 2;

// The best pose of one board over all turns of b's view; sets the turn.
PoseChoice ChooseTurnAndPose(const StereoProblem& problem, std::size_t k, StereoWork& work) {
  JointCapture& capture = work.joint.captures[k];
  const int turns = capture.a.empty() || capture.b.empty() ? 1 : SymmetryOf(problem.board);
  PoseChoice best;
  SeenCorners best_b = capture.b;
  for (int turn = 0; turn < turns; ++turn) {
    if (turns > 1) capture.b = SeenIn(*problem.captures[work.used[k]].b, problem.board, turn);
    const PoseChoice choice = ChoosePose(work.joint, work.state, k, AllowedPoses(work.joint, work.state, k));
    if (turn > 0 && !(choice.ssr_px2 < best.ssr_px2)) continue;
    best = choice;
    best_b = capture.b;
    work.turns_b[k] = turn;
  }
  capture.b = std::move(best_b);
  return best;
}

// One look at every board's other pose. Returns whether anything changed.
bool ReconsiderBoards(const StereoProblem& problem, StereoWork& work, std::vector<CaptureId>& ambiguous) {
  const double s2_px2 = work.Variance_px2();
  bool changed = false;
  for (std::size_t k = work.used.size(); k-- > 0;) {
    std::vector<Se3> candidates = AllowedPoses(work.joint, work.state, k);
    candidates.insert(candidates.begin(), work.state.T_a_board[k]);
    const PoseChoice choice = ChoosePose(work.joint, work.state, k, candidates);
    if (choice.other_ssr_px2 - choice.ssr_px2 < kAmbiguousCost * s2_px2) {
      ambiguous.push_back(problem.captures[work.used[k]].capture);
      work.Drop(k, "two poses of the board fit equally");
      changed = true;
    } else if ((work.state.T_a_board[k].Inverse() * choice.T_a_board).Log().norm() > 1e-3) {
      work.state.T_a_board[k] = choice.T_a_board;
      changed = true;
    }
  }
  return changed;
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
  const CameraViews views_a = ViewsOf(problem, work.used, &StereoCapture::a),
                    views_b = ViewsOf(problem, work.used, &StereoCapture::b);
  RIGCAL_ASSIGN(const auto intrinsics_a, StartOf(problem, problem.camera_a, views_a));
  RIGCAL_ASSIGN(const auto intrinsics_b, StartOf(problem, problem.camera_b, views_b));
  work.state.intrinsics_a = intrinsics_a;
  work.state.intrinsics_b = intrinsics_b;
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

void StereoWork::Drop(std::size_t position, const std::string& why) {
  unused[used[position]] = why;
  EraseAt(position, used, turns_b, joint.captures, state.T_a_board);
}

double StereoWork::Variance_px2() const {
  return SumOfSquares_px2(joint, state) / (ResidualCount(joint) - ParameterCount(joint));
}

std::vector<CaptureId> PlaceBoards(const StereoProblem& problem, double width_px, StereoWork& work) {
  work.state.T_a_board.resize(work.used.size());
  work.turns_b.assign(work.used.size(), 0);
  std::vector<double> rms_px;
  for (std::size_t k = 0; k < work.used.size(); ++k) {
    const PoseChoice choice = ChooseTurnAndPose(problem, k, work);
    work.state.T_a_board[k] = choice.T_a_board;
    const JointCapture& capture = work.joint.captures[k];
    rms_px.push_back(std::sqrt(choice.ssr_px2 / static_cast<double>(capture.a.size() + capture.b.size())));
  }
  const double limit_px = ContradictingRms_px(rms_px, width_px);
  std::vector<CaptureId> contradicting;
  for (std::size_t k = work.used.size(); k-- > 0;) {
    if (rms_px[k] <= limit_px && std::isfinite(rms_px[k])) continue;
    contradicting.insert(contradicting.begin(), problem.captures[work.used[k]].capture);
    work.Drop(k, "its pictures contradict the other captures");
  }
  return contradicting;
}

OrDiagnosis<void> Refine(const StereoProblem& problem, StereoWork& work) {
  auto solution = SolveJoint(work.joint, work.state);
  if (!solution) return tl::unexpected(FromError(problem, "no_convergence", solution.error()));
  work.state = std::move(solution->state);
  work.iterations += solution->iterations;
  return {};
}

// What the corners are good for is known once they fit, and they fit a little better once it is known.
OrDiagnosis<void> RefineAgainstGiven(const StereoProblem& problem, StereoWork& work) {
  const bool pulled = work.joint.a.pull.Pulls() || work.joint.b.pull.Pulls();
  for (int round = 1; pulled && round < kPulledRounds; ++round) {
    SetCornerSigma(problem, std::sqrt(work.Variance_px2()), work.joint);
    if (auto refined = Refine(problem, work); !refined) return refined;
  }
  if (pulled) SetCornerSigma(problem, std::sqrt(work.Variance_px2()), work.joint);
  return Refine(problem, work);
}

OrDiagnosis<void> RefineWithChoices(const StereoProblem& problem, StereoWork& work, std::vector<Diagnosis>& notes) {
  std::vector<CaptureId> ambiguous;
  for (int round = 0; round < kPoseRoundsMax; ++round) {
    if (auto refined = Refine(problem, work); !refined) return refined;
    if (!ReconsiderBoards(problem, work, ambiguous)) break;
    std::sort(ambiguous.begin(), ambiguous.end());
    if (CountBoth(problem, work.used) < kCapturesMin) return tl::unexpected(AmbiguousPose(problem, ambiguous));
  }
  if (!ambiguous.empty()) notes.push_back(AmbiguousPose(problem, ambiguous));
  return RefineAgainstGiven(problem, work);
}

}  // namespace rigcal::calib
