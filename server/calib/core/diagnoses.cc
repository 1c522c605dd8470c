#include "server/calib/core/diagnoses.h"

#include <cstdio>

#include "server/calib/camera/camera_diagnoses.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/selection.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kNamesShown = 8;

std::string PairOf(const StereoProblem& problem) {
  return problem.camera_a.id.str() + " and " + problem.camera_b.id.str();
}

std::string CapturesText(std::size_t count) { return std::to_string(count) + (count == 1 ? " capture" : " captures"); }
std::string OnlyCapturesText(std::size_t count) { return count == 0 ? "no capture" : "only " + CapturesText(count); }

std::string Number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

std::string NamesOf(const std::vector<CaptureId>& captures) {
  std::string names;
  for (std::size_t i = 0; i < captures.size() && i < kNamesShown; ++i)
    names += (i == 0 ? "" : ", ") + captures[i].str();
  if (captures.size() > kNamesShown) names += " and " + std::to_string(captures.size() - kNamesShown) + " more";
  return names;
}

Diagnosis TooFewCaptures(const StereoProblem& problem, std::size_t both) {
  return {"too_few_captures",
          PairOf(problem) + " see the board together in " + OnlyCapturesText(both) + "; at least " +
              std::to_string(kCapturesMin) + " are needed.",
          "Take 10 to 20 captures in which both cameras see the board, tilted in different directions."};
}

Diagnosis FewCaptures(const StereoProblem& problem, std::size_t both) {
  return {"few_captures",
          PairOf(problem) + " see the board together in only " + CapturesText(both) + "; with fewer than " +
              std::to_string(kCapturesEnough) +
              (both < kCapturesForJackknife ? " the uncertainty comes from the model alone and is probably too small."
                                            : " the uncertainty is itself uncertain."),
          "Take 10 to 20 captures in which both cameras see the board."};
}

Diagnosis NoCommonView(const StereoProblem& problem) {
  return {"no_common_view", PairOf(problem) + " both see the board, but never in the same capture.",
          "Hold the board where both pictures overlap, and name the two pictures of one instant alike."};
}

namespace {

// What the search said of the first of these captures: an unreadable file is not a hidden board.
std::string ReasonOf(const StereoProblem& problem, const SensorId& camera, const std::vector<CaptureId>& captures) {
  for (const StereoCapture& capture : problem.captures) {
    if (captures.empty() || capture.capture != captures.front()) continue;
    const std::optional<BoardView>& view = camera == problem.camera_a.id ? capture.a : capture.b;
    const std::string reason =
        view ? WhyUnusable(*view, problem.board) : "there is no picture of that name in the folder of " + camera.str();
    return reason.empty() ? "" : " The first of them: " + reason + (reason.back() == '.' ? "" : ".");
  }
  return "";
}

}  // namespace

Diagnosis BoardNotFound(const StereoProblem& problem, const SensorId& camera, const std::vector<CaptureId>& captures) {
  return {"board_not_found",
          camera.str() + " does not show the " + std::to_string(problem.board.cols) + " x " +
              std::to_string(problem.board.rows) + " target '" + problem.board.id.str() + "' in " +
              CapturesText(captures.size()) + ": " + NamesOf(captures) + "." + ReasonOf(problem, camera, captures),
          "Show the whole board, sharp and evenly lit, and check its description in session.yaml."};
}

Diagnosis Unreadable(const SensorId& camera, const std::vector<CaptureId>& captures, const std::string& first_reason) {
  return {"picture_unreadable",
          std::to_string(captures.size()) + (captures.size() == 1 ? " picture of " : " pictures of ") + camera.str() +
              " cannot be read and take no part: " + NamesOf(captures) + "." + first_reason,
          "Copy the files again from where they were recorded, or take those captures again."};
}

std::vector<Diagnosis> Missed(const StereoProblem& problem, std::optional<BoardView> StereoCapture::*camera) {
  std::vector<CaptureId> unreadable, other_layout, without_board;
  for (const StereoCapture& capture : problem.captures) {
    const std::optional<BoardView>& view = capture.*camera;
    if (Sees(view, problem.board)) continue;
    const bool readable = !view || view->found || view->image_width_px > 0;
    const bool misdescribed = view && ShowsOtherLayout(*view);
    (misdescribed ? other_layout : readable ? without_board : unreadable).push_back(capture.capture);
  }
  const SensorId& id = camera == &StereoCapture::a ? problem.camera_a.id : problem.camera_b.id;
  std::vector<Diagnosis> diagnoses;
  if (!other_layout.empty()) diagnoses.push_back(OtherLayout(id, problem.board, other_layout));
  if (!unreadable.empty()) diagnoses.push_back(Unreadable(id, unreadable, ReasonOf(problem, id, unreadable)));
  if (!without_board.empty()) diagnoses.push_back(BoardNotFound(problem, id, without_board));
  return diagnoses;
}

Diagnosis ImageSizeChanged(const SensorId& camera, const std::vector<CaptureId>& captures) {
  return {"image_size_changed",
          "The pictures of " + camera.str() + " differ in size: those of " + NamesOf(captures) +
              " are not as large as the first.",
          "Take all pictures of one camera at one resolution, and push them as they come from the camera."};
}

Diagnosis IdenticalCaptures(const StereoProblem& problem, const std::vector<CaptureId>& captures) {
  return {"identical_captures",
          PairOf(problem) + ": " + CapturesText(captures.size()) + " (" + NamesOf(captures) +
              ") repeat another and give no new information; they are not used.",
          "Move and tilt the board between captures."};
}

Diagnosis NoTilt(const SensorId& camera, double spread_deg, double focal_sigma_ratio) {
  return {"no_tilt",
          "The boards that " + camera.str() + " sees differ in orientation by at most " + Number("%.1f", spread_deg) +
              " deg, so its focal length would be uncertain by " +
              (focal_sigma_ratio < 1 ? Number("%.0f", 100 * focal_sigma_ratio) : "more than 100") + " %.",
          "Tilt the board by 20 to 40 deg to the left, right, up and down, or give the intrinsics of " + camera.str() +
              " in session.yaml."};
}

Diagnosis AmbiguousPose(const StereoProblem& problem, const std::vector<CaptureId>& captures) {
  return {"ambiguous_pose",
          PairOf(problem) + ": in " + CapturesText(captures.size()) + " (" + NamesOf(captures) +
              ") the board is so small or so flat to the picture that two poses fit it equally; they are not used.",
          "Hold the board nearer, so that it fills a third of the picture, and tilt it."};
}

Diagnosis AmbiguousBoard(const StereoProblem& problem, std::size_t captures, std::size_t poses) {
  const int turn_deg = 360 / SymmetryOf(problem.board);
  return {"ambiguous_board",
          PairOf(problem) + ": target '" + problem.board.id.str() + "' (" + std::to_string(problem.board.cols) + " x " +
              std::to_string(problem.board.rows) + ") looks the same turned by " + std::to_string(turn_deg) +
              " deg, and its " + CapturesText(captures) + " fit " + std::to_string(poses) +
              " different poses of the cameras equally.",
          "Give nominal poses of both cameras in session.yaml, or use a board with one odd and one even count of inner "
          "corners, or tilt and move the board between captures."};
}

Diagnosis InconsistentCaptures(const StereoProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          PairOf(problem) + ": the two pictures of " + NamesOf(captures) +
              " contradict the other captures; they are not used.",
          "Check that they show the same instant and that their names were not swapped."};
}

Diagnosis HighResidual(const StereoProblem& problem, double rms_px, double limit_px,
                       const std::vector<CaptureId>& worst) {
  return {
      "high_residual",
      PairOf(problem) + " fit the corners to " + Number("%.2f", rms_px) + " px rms, more than " +
          Number("%.2f", limit_px) + " px; the worst captures are " + NamesOf(worst) + ".",
      "Check that the pictures of a capture show the same instant, that the board is flat and its counts and square "
      "size are right, and that given intrinsics belong to these cameras."};
}

Diagnosis IllConditioned(const StereoProblem& problem, const std::string& why) {
  return {"ill_conditioned", PairOf(problem) + ": the result has no usable uncertainty (" + why + ").",
          "Take more captures with the board tilted in different directions, near and far, in all corners."};
}

Diagnosis IntrinsicsTakenAsExact(const SensorId& camera) {
  return {"intrinsics_taken_as_exact",
          "The intrinsics of " + camera.str() + " are given without an uncertainty and taken as exact.",
          "Give 'sigma' with the intrinsics in session.yaml, or leave the intrinsics out to have them estimated."};
}

Diagnosis FromError(const StereoProblem& problem, const std::string& code, const Error& error) {
  return {code, PairOf(problem) + ": " + error.what + ".", error.cure};
}

}  // namespace rigcal::calib
