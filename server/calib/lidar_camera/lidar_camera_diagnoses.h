// The sentences of lidar-camera calibration. Each names the sensors and captures it is about, and what to do.
#pragma once

#include "server/calib/core/wording.h"
#include "server/calib/lidar_camera/lidar_camera.h"
#include "server/model/edges/method.h"

namespace rigcal::calib {

constexpr std::size_t kLidarCapturesMin = RowOf(Method::kLidarCamera).captures.least;  // seen by both
constexpr std::size_t kLidarCapturesForJackknife = 5;  // fewer: the uncertainty is the model's
constexpr std::size_t kLidarViewsForIntrinsics = 8;    // pictures; fewer: intrinsics must be given
constexpr std::size_t kLidarCapturesEnough = RowOf(Method::kLidarCamera).captures.enough;  // fewer: a note says so
// With planes known to 10 mm each: worse than this along some direction is no calibration, and a note below.
constexpr double kNormalSigmaMax_m = 0.05, kNormalSigmaGood_m = 0.02;
// Residuals beyond these mean that something is wrong, not noisy.
constexpr double kHighRms_m = 0.05, kHighRms_rad = 0.07;
// A range bias is suspected beyond so many of its sigmas, and from so much.
constexpr double kBiasSigmas = 3.0, kBiasMin_m = 0.005;
// A board of another size likewise; beyond the last two nothing is good any more.
constexpr double kScaleMin_ratio = 0.002, kScaleMax_ratio = 0.02, kBiasMax_m = 0.1;

[[nodiscard]] std::string BoardOf(const LidarCameraProblem& problem);  // "target 'calib'"

// "too_few_captures": picture and cloud show the board in only `both` captures.
[[nodiscard]] Diagnosis TooFewLidarCaptures(const LidarCameraProblem& problem, std::size_t both);
[[nodiscard]] Diagnosis FewLidarCaptures(const LidarCameraProblem& problem, std::size_t used);  // a note
// "board_not_found_in_cloud", "no_agreement", "ambiguous_board" and "no_normal_spread". `supporters`: captures that
// agree with the best pose; `others`: with the next; `sigma_m`: of the worst direction, as in NormalSpread.
[[nodiscard]] Diagnosis BoardNotInClouds(const LidarCameraProblem& problem, const MissedCaptures& missed);
[[nodiscard]] Diagnosis NoAgreement(const LidarCameraProblem& problem, std::size_t both, std::size_t supporters);
[[nodiscard]] Diagnosis AmbiguousBoard(const LidarCameraProblem& problem, std::size_t supporters, std::size_t others);
[[nodiscard]] Diagnosis NoNormalSpread(const LidarCameraProblem& problem, double cone_deg, double sigma_m);
[[nodiscard]] Diagnosis NormalsInOnePlane(const LidarCameraProblem& problem,
                                          const Eigen::Vector3d& axis_cam);                                    // a note
[[nodiscard]] Diagnosis WeakNormalSpread(const LidarCameraProblem& problem, double cone_deg, double sigma_m);  // a note
// "inconsistent_captures": those that were left out; "high_residual": beyond kHighRms_m or kHighRms_rad.
[[nodiscard]] Diagnosis ContradictingClouds(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis HighLidarResidual(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate);
[[nodiscard]] Diagnosis RangeBiasSuspected(const LidarCameraProblem& problem,
                                           const LidarCameraEstimate& estimate);  // a note
// "too_few_captures": so few views do not carry intrinsics beside the pose; "captures_disagree": files that seem
// exchanged; and the board's size as picture and cloud together have it.
[[nodiscard]] Diagnosis TooFewForIntrinsics(const LidarCameraProblem& problem, std::size_t views);
[[nodiscard]] Diagnosis CapturesDisagree(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures);
[[nodiscard]] Diagnosis BoardSizeSuspected(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate);
[[nodiscard]] Diagnosis BoardSizeTakenAsExact(const LidarCameraProblem& problem);  // a note
// "ill_conditioned", in the solver's words.
[[nodiscard]] Diagnosis NotSolvable(const LidarCameraProblem& problem, const Error& error);

}  // namespace rigcal::calib
