#include "server/calib/core/diagnoses.h"

#include <cmath>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/selection.h"

namespace rigcal::calib {
namespace {

std::string PairOf(const StereoProblem& problem) {
  return problem.camera_a.id.str() + " and " + problem.camera_b.id.str();
}

// What the search said of a capture: an unreadable file is not a hidden board.
std::string ReasonOf(const std::optional<BoardView>& view, const SensorId& camera, const Target& board) {
  return view ? WhyUnusable(*view, board) : "there is no picture of that name in the folder of " + camera.str();
}

}  // namespace

Diagnosis TooFewCaptures(const StereoProblem& problem, std::size_t both) {
  return {"too_few_captures",
          Worded("{} see the board together in {}; at least {} are needed.",
                 {PairOf(problem), OnlyCapturesText(both), kCapturesMin}),
          "Take 10 to 20 captures in which both cameras see the board, tilted in different directions."};
}

Diagnosis FewCaptures(const StereoProblem& problem, std::size_t both) {
  return {"few_captures",
          Worded("{} see the board together in only {}; with fewer than {}{}",
                 {PairOf(problem), CountText(both), kCapturesEnough, FewMeanText(both, kCapturesForJackknife)}),
          "Take 10 to 20 captures in which both cameras see the board."};
}

Diagnosis NoCommonView(const StereoProblem& problem) {
  return {"no_common_view", PairOf(problem) + " both see the board, but never in the same capture.",
          "Hold the board where both pictures overlap, and name the two pictures of one instant alike."};
}

std::vector<Diagnosis> Missed(const StereoProblem& problem, std::optional<BoardView> StereoCapture::*camera) {
  const SensorId& id = SensorOf(problem, camera).id;
  const Target& board = problem.board;
  MissedCaptures unreadable, other_layout, without_board;
  for (const StereoCapture& capture : problem.captures) {
    const std::optional<BoardView>& view = capture.*camera;
    if (Sees(view, board)) continue;
    const bool readable = !view || view->found || view->image_width_px > 0;
    const bool misdescribed = view && ShowsOtherLayout(*view);
    (misdescribed ? other_layout
     : readable   ? without_board
                  : unreadable)
        .Add(capture.capture, ReasonOf(view, id, board));
  }
  std::vector<Diagnosis> diagnoses;
  if (!other_layout.captures.empty()) diagnoses.push_back(OtherLayout(id, board, other_layout.captures));
  if (!unreadable.captures.empty()) diagnoses.push_back(Unreadable(id, unreadable));
  if (!without_board.captures.empty())
    diagnoses.push_back(
        BoardNotFound(id, Worded("the {} x {} target '{}'", {board.cols, board.rows, board.id}), without_board));
  return diagnoses;
}

Diagnosis ImageSizeChanged(const SensorId& camera, const std::vector<CaptureId>& captures) {
  return {"image_size_changed",
          Worded("The pictures of {} differ in size: those of {} are not as large as the first.",
                 {camera, NamesOf(captures)}),
          "Take all pictures of one camera at one resolution, and push them as they come from the camera."};
}

Diagnosis IdenticalCaptures(const StereoProblem& problem, const std::vector<CaptureId>& captures) {
  return {"identical_captures",
          Worded("{}: {} ({}) repeat another and give no new information; they are not used.",
                 {PairOf(problem), CountText(captures.size()), NamesOf(captures)}),
          "Move and tilt the board between captures."};
}

Diagnosis NoTilt(const SensorId& camera, double spread_deg, double focal_sigma_ratio) {
  return {"no_tilt",
          Worded("The boards that {} sees differ in orientation by at most {} deg, so its focal length would be "
                 "uncertain by {} %.",
                 {camera, Formatted("%.1f", spread_deg),
                  focal_sigma_ratio < 1 ? Formatted("%.0f", 100 * focal_sigma_ratio) : "more than 100"}),
          Worded("Tilt the board by 20 to 40 deg to the left, right, up and down, or give the intrinsics of {} in "
                 "session.yaml.",
                 {camera}),
          {{"board_tilt_rad", spread_deg * M_PI / 180}}};
}

Diagnosis AmbiguousPose(const StereoProblem& problem, const std::vector<CaptureId>& captures) {
  return {"ambiguous_pose",
          Worded("{}: in {} ({}) the board is so small or so flat to the picture that two poses fit it equally; they "
                 "are not used.",
                 {PairOf(problem), CountText(captures.size()), NamesOf(captures)}),
          "Hold the board nearer, so that it fills a third of the picture, and tilt it."};
}

Diagnosis AmbiguousBoard(const StereoProblem& problem, std::size_t captures, std::size_t poses) {
  const Target& board = problem.board;
  return {
      "ambiguous_board",
      Worded("{}: target '{}' ({} x {}) looks the same turned by {} deg, and its {} fit {} different poses of the "
             "cameras equally.",
             {PairOf(problem), board.id, board.cols, board.rows, 360 / SymmetryOf(board), CountText(captures), poses}),
      "Give nominal poses of both cameras in session.yaml, or use a board with one odd and one even count of inner "
      "corners, or tilt and move the board between captures."};
}

Diagnosis InconsistentCaptures(const StereoProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          Worded("{}: the two pictures of {} contradict the other captures; they are not used.",
                 {PairOf(problem), NamesOf(captures)}),
          "Check that they show the same instant and that their names were not swapped."};
}

Diagnosis HighResidual(const StereoProblem& problem, double rms_px, double limit_px,
                       const std::vector<CaptureId>& worst) {
  return {
      "high_residual",
      Worded("{} fit the corners to {} px rms, more than {} px; the worst captures are {}.",
             {PairOf(problem), Formatted("%.2f", rms_px), Formatted("%.2f", limit_px), NamesOf(worst)}),
      "Check that the pictures of a capture show the same instant, that the board is flat and its counts and square "
      "size are right, and that given intrinsics belong to these cameras."};
}

Diagnosis PairMoved(const StereoProblem& problem, const PairMove& move) {
  const double step_m = move.step.head<3>().norm(), step_rad = move.step.tail<3>().norm();
  return {"moved_within",
          Worded("{}: one of the two was moved between captures {} and {}, by {} mm and {} deg, or a lens of theirs "
                 "changed: before and after that they fit to {} px, by one pose for all captures they do not.",
                 {PairOf(problem), problem.captures[move.last_before_idx].capture.str(),
                  problem.captures[move.first_after_idx].capture.str(), Formatted("%.3g", 1e3 * step_m),
                  Formatted("%.3g", step_rad * 180 / M_PI), Formatted("%.2f", move.rms_px)}),
          Worded("Tighten the mounts of {} and {}, lock focus and zoom, and capture again.",
                 {problem.camera_a.id, problem.camera_b.id}),
          {{"moved_m", step_m}, {"moved_rad", step_rad}}};
}

Diagnosis IllConditioned(const StereoProblem& problem, const std::string& why) {
  return {"ill_conditioned", Worded("{}: the result has no usable uncertainty ({}).", {PairOf(problem), why}),
          "Take more captures with the board tilted in different directions, near and far, in all corners."};
}

Diagnosis FromError(const StereoProblem& problem, const std::string& code, const Error& error) {
  return AsDiagnosis(PairOf(problem), code, error);
}

}  // namespace rigcal::calib
