// The sentences about a camera pair, and about the views of one camera. Each names the sensors and captures it is
// about, and what to do.
#pragma once

#include <string>
#include <vector>

#include "server/calib/core/wording.h"
#include "server/calib/stereo/moved_pair.h"
#include "server/calib/stereo/stereo.h"
#include "server/model/edges/method.h"

namespace rigcal::calib {

constexpr std::size_t kCapturesMin = RowOf(Method::kStereo).captures.least;  // seen by both cameras
constexpr std::size_t kCapturesForJackknife = 5;  // likewise; fewer: the uncertainty is the model's
// Likewise; fewer: the jackknife has so few blocks that a note says so.
constexpr std::size_t kCapturesEnough = RowOf(Method::kStereo).captures.enough;
// Residuals beyond this mean that something is wrong, not noisy: a part of the picture's width, and at least one pixel.
constexpr double kHighRmsRatio = 1.0 / 600;

// "too_few_captures": `both` is how many show the board to both.
[[nodiscard]] Diagnosis TooFewCaptures(const StereoProblem& problem, std::size_t both);
[[nodiscard]] Diagnosis FewCaptures(const StereoProblem& problem, std::size_t both);  // a note on a good edge
// "no_common_view": each camera sees the board, but never both in one capture.
[[nodiscard]] Diagnosis NoCommonView(const StereoProblem& problem);
// The captures that a camera (&StereoCapture::a or b) misses: "board_layout", "picture_unreadable" and
// "board_not_found", where there are any.
[[nodiscard]] std::vector<Diagnosis> Missed(const StereoProblem& problem,
                                            std::optional<BoardView> StereoCapture::*camera);
[[nodiscard]] Diagnosis ImageSizeChanged(const SensorId& camera, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis IdenticalCaptures(const StereoProblem& problem, const std::vector<CaptureId>& captures);
// `focal_sigma_ratio`: predicted sigma of the focal length over the focal length.
[[nodiscard]] Diagnosis NoTilt(const SensorId& camera, double spread_deg, double focal_sigma_ratio);
[[nodiscard]] Diagnosis AmbiguousPose(const StereoProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis AmbiguousBoard(const StereoProblem& problem, std::size_t captures, std::size_t poses);
[[nodiscard]] Diagnosis InconsistentCaptures(const StereoProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis HighResidual(const StereoProblem& problem, double rms_px, double limit_px,
                                     const std::vector<CaptureId>& worst);
// "moved_within", with "moved_m" and "moved_rad".
[[nodiscard]] Diagnosis PairMoved(const StereoProblem& problem, const PairMove& move);
[[nodiscard]] Diagnosis IllConditioned(const StereoProblem& problem, const std::string& why);
[[nodiscard]] Diagnosis FromError(const StereoProblem& problem, const std::string& code, const Error& error);

}  // namespace rigcal::calib
