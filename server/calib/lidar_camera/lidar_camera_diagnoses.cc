#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"

#include <cmath>

namespace rigcal::calib {
namespace {

constexpr const char* kTakeMore =
    "Take 15 to 30 captures with the board 2 to 6 m away, in different places, tilted by 20 to 45 degrees to all "
    "sides.";

std::string PairOf(const LidarCameraProblem& problem) {
  return problem.camera.id.str() + " and " + problem.lidar.id.str();
}

std::string SpreadText(const LidarCameraProblem& problem, double cone_deg, double sigma_m) {
  return Worded(
      "{}: the boards' normals differ by at most {} degrees or lie in one plane: with planes known to 10 mm "
      "the translation would be uncertain by {}.",
      {PairOf(problem), Formatted("%.0f", cone_deg), sigma_m < 10 ? MillimetresText(sigma_m) : "metres"});
}

}  // namespace

std::string BoardOf(const LidarCameraProblem& problem) { return "target '" + problem.board.id.str() + "'"; }

Diagnosis TooFewLidarCaptures(const LidarCameraProblem& problem, std::size_t both) {
  return {"too_few_captures",
          Worded("{} see {} together in {}; at least {} are needed.",
                 {PairOf(problem), BoardOf(problem), OnlyCapturesText(both), kLidarCapturesMin}),
          kTakeMore};
}

Diagnosis FewLidarCaptures(const LidarCameraProblem& problem, std::size_t used) {
  return {"few_captures",
          Worded("{} see {} together in only {}; with fewer than {} the uncertainty itself is rough.",
                 {PairOf(problem), BoardOf(problem), CountText(used), kLidarCapturesEnough}),
          kTakeMore};
}

Diagnosis BoardNotInClouds(const LidarCameraProblem& problem, const MissedCaptures& missed) {
  return {
      "board_not_found_in_cloud",
      Worded("{} does not show {} in {}: {}.{}", {problem.lidar.id, BoardOf(problem), CountText(missed.captures.size()),
                                                  NamesOf(missed.captures), missed.first_reason}),
      "Hold the board free of walls and furniture, near enough for several beams to cross it, and check plate_size_m "
      "in session.yaml."};
}

Diagnosis NoAgreement(const LidarCameraProblem& problem, std::size_t both, std::size_t supporters) {
  return {"no_agreement",
          Worded("no pose of {} puts a patch of the cloud where {} sees {} in more than {} of {}.",
                 {problem.lidar.id, problem.camera.id, BoardOf(problem), supporters, CountText(both)}),
          "Check plate_size_m and the size of squares, tags or spacings, that pictures and clouds of one name were "
          "taken together, and that the "
          "board stood still."};
}

Diagnosis AmbiguousBoard(const LidarCameraProblem& problem, std::size_t supporters, std::size_t others) {
  return {"ambiguous_board",
          Worded("{} could be two different things in the clouds of {}: one pose agrees with {}, another with {}.",
                 {BoardOf(problem), problem.lidar.id, CountText(supporters), others}),
          "Give nominal poses of both sensors in session.yaml, or take captures in more places and tilts."};
}

Diagnosis NoNormalSpread(const LidarCameraProblem& problem, double cone_deg, double sigma_m) {
  return {"no_normal_spread", SpreadText(problem, cone_deg, sigma_m),
          "Tilt the board by 20 to 45 degrees, to the left and right as well as up and down, and take more captures."};
}

Diagnosis NormalsInOnePlane(const LidarCameraProblem& problem, const Eigen::Vector3d& axis_cam) {
  return {"normals_in_one_plane",
          Worded("{}: the normals of all boards lie in one plane or nearly so, so that nothing tells where {} is along "
                 "{} in the frame of {}. It is near where the nominal poses or the boards' middles have it, and "
                 "nothing is claimed there.",
                 {PairOf(problem), problem.lidar.id, LineText(axis_cam), problem.camera.id}),
          "Tilt the board by 20 to 45 degrees up and down as well, or tilt the robot, and take more captures."};
}

Diagnosis WeakNormalSpread(const LidarCameraProblem& problem, double cone_deg, double sigma_m) {
  return {"weak_normal_spread", SpreadText(problem, cone_deg, sigma_m),
          "Add captures with the board tilted by 20 to 45 degrees, to the left and right as well as up and down."};
}

Diagnosis ContradictingClouds(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          Worded("{}: picture and cloud of {} contradict the others and were left out: {}.",
                 {PairOf(problem), CountText(captures.size()), NamesOf(captures)}),
          "Check that the board stood still and that pictures and clouds of one name were taken together."};
}

Diagnosis HighLidarResidual(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  return {"high_residual",
          Worded("{}: the boards in picture and cloud are apart by {} and {} (rms), more than {} or {}.",
                 {PairOf(problem), MillimetresText(estimate.rms_m), DegreesText(estimate.rms_rad),
                  MillimetresText(kHighRms_m), DegreesText(kHighRms_rad)}),
          "Check the board's size in session.yaml and the camera's intrinsics, and that the board is flat and stood "
          "still."};
}

Diagnosis RangeBiasSuspected(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const double bias_m = estimate.range_bias_m;
  return {"range_bias_suspected",
          Worded("{} seems to measure all distances {} too {} (+- {}). It is not corrected; what it would change is "
                 "part of the uncertainty.",
                 {problem.lidar.id, MillimetresText(std::abs(bias_m)), bias_m > 0 ? "short" : "long",
                  MillimetresText(estimate.range_bias_sigma_m)}),
          "Check the size of squares, tags or spacings, then compare the lidar with a tape measure against a flat "
          "wall, and correct its ranges "
          "in its driver."};
}

Diagnosis TooFewForIntrinsics(const LidarCameraProblem& problem, std::size_t views) {
  return {"too_few_captures",
          Worded("{} has no given intrinsics and shows {} in only {}; at least {} are needed to estimate them beside "
                 "the lidar's pose.",
                 {problem.camera.id, BoardOf(problem), CountText(views), kLidarViewsForIntrinsics}),
          "Take more captures, or give the camera's intrinsics in session.yaml."};
}

Diagnosis CapturesDisagree(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {"captures_disagree",
          Worded("The picture of {} and the cloud of {} do not show the board in the same place in {}: {}.",
                 {problem.camera.id, problem.lidar.id, CountText(captures.size()), NamesOf(captures)}),
          "Check that the names of these files were not exchanged, and that the board stood still and free."};
}

Diagnosis BoardSizeSuspected(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  return OtherBoardSize(problem.board, estimate.board_scale_ratio, estimate.board_scale_sigma_ratio,
                        "picture and cloud", "lidar");
}

Diagnosis BoardSizeTakenAsExact(const LidarCameraProblem& problem) {
  return {"board_size_taken_as_exact", Worded("The size of {} is taken as exact.", {BoardOf(problem)}),
          "Give its standard deviation in session.yaml (square_size_sigma_m, tag_size_sigma_m or spacing_sigma_m): 0.3 "
          "% move a lidar "
          "at 4 m by a centimetre."};
}

Diagnosis NotSolvable(const LidarCameraProblem& problem, const Error& error) {
  const bool names_it = error.what.starts_with(PairOf(problem) + ": ");  // of a solve without a capture, say
  return names_it ? Diagnosis{"ill_conditioned", error.what, error.cure}
                  : AsDiagnosis(PairOf(problem), "ill_conditioned", error);
}

}  // namespace rigcal::calib
