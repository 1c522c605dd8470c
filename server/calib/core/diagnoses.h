// The sentences of this module. Each names the sensors and captures it is about, and what to do.
#pragma once

#include <string>
#include <vector>

#include "server/calib/stereo/stereo.h"

namespace rigcal::calib {

constexpr std::size_t kCapturesMin = 3;           // seen by both cameras
constexpr std::size_t kCapturesForJackknife = 5;  // likewise; fewer: the uncertainty is the model's
constexpr std::size_t kCapturesEnough = 8;  // likewise; fewer: the jackknife has so few blocks that a note says so
// Residuals beyond this mean that something is wrong, not noisy: a part of the picture's width, and at least one pixel.
constexpr double kHighRmsRatio = 1.0 / 600;

// The cure of a motion that leaves directions open.
inline constexpr const char* kTurnMore =
    "Turn the robot by 20 degrees and more about two different axes; ramps of 5 degrees under its wheels, and turns "
    "on them, help.";

// "001, 002, 003 and 9 more".
[[nodiscard]] std::string NamesOf(const std::vector<CaptureId>& captures);

[[nodiscard]] Diagnosis TooFewCaptures(const StereoProblem& problem, std::size_t both);
[[nodiscard]] Diagnosis FewCaptures(const StereoProblem& problem, std::size_t both);  // a note on a good edge
[[nodiscard]] Diagnosis NoCommonView(const StereoProblem& problem);
[[nodiscard]] Diagnosis BoardNotFound(const StereoProblem& problem, const SensorId& camera,
                                      const std::vector<CaptureId>& captures);
// "picture_unreadable": files that hold no picture; a board was not even looked for.
// `first_reason`: a sentence about the first of them, with a blank before it, or nothing.
[[nodiscard]] Diagnosis Unreadable(const SensorId& camera, const std::vector<CaptureId>& captures,
                                   const std::string& first_reason);
// The captures that a camera (&StereoCapture::a or b) misses: none, or one or both of the two above.
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
[[nodiscard]] Diagnosis IllConditioned(const StereoProblem& problem, const std::string& why);
[[nodiscard]] Diagnosis IntrinsicsTakenAsExact(const SensorId& camera);  // a note on a good edge
[[nodiscard]] Diagnosis FromError(const StereoProblem& problem, const std::string& code, const Error& error);

}  // namespace rigcal::calib
