// The sentences of hand-eye calibration. Each names the sensors and captures it is about, and what to do.
#pragma once

#include <vector>

#include "server/calib/motion/hand_eye.h"

namespace rigcal::calib {

// `both`: captures with a pose each, those that repeat another left out; `repeated`: how many those are.
[[nodiscard]] Diagnosis TooFewMotions(const HandEyeProblem& problem, std::size_t both, std::size_t repeated);
// Of pose streams: places of the path at which both have a pose, in the time that both recorded.
[[nodiscard]] Diagnosis TooFewSamples(const HandEyeProblem& problem, std::size_t samples, std::size_t needed,
                                      double common_s);
[[nodiscard]] Diagnosis FewMotions(const HandEyeProblem& problem, std::size_t used);  // a note
// A camera that gives no poses: its own diagnosis, and for which pair.
[[nodiscard]] Diagnosis CameraFailed(const HandEyeProblem& problem, const HandEyeSide& side, const Diagnosis& why);
[[nodiscard]] Diagnosis MotionsContradict(const HandEyeProblem& problem, std::size_t captures);
[[nodiscard]] Diagnosis CapturesContradict(const HandEyeProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis MotionNotSolvable(const HandEyeProblem& problem, const Error& error);
[[nodiscard]] Diagnosis HighMotionResidual(const HandEyeProblem& problem, const HandEyeEstimate& estimate);
[[nodiscard]] Diagnosis NoMotion(const HandEyeProblem& problem);
// Codes "planar_motion", "turning_on_the_spot", "pure_translation", "straight_line": notes on a good edge that say
// which direction is not known. Nothing where all are.
[[nodiscard]] std::vector<Diagnosis> OpenDirections(const HandEyeProblem& problem, const MotionReach& reach);
// "board_layout", "picture_unreadable", "board_not_found": of the cameras.
[[nodiscard]] std::vector<Diagnosis> MissedViews(const HandEyeProblem& problem);
// Constants that were given without a sigma: notes on a good edge.
[[nodiscard]] std::vector<Diagnosis> TakenAsExact(const HandEyeProblem& problem);
// Two pose streams whose turns have nothing in common: too short, too still, or not of the same time.
[[nodiscard]] Diagnosis NoCommonTime(const HandEyeProblem& problem, double correlation_ratio);

}  // namespace rigcal::calib
