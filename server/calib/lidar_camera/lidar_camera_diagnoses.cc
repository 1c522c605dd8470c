#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"

#include <cstdio>

#include "server/calib/core/diagnoses.h"

namespace rigcal::calib {
namespace {

constexpr const char* kTakeMore =
    "Take 15 to 30 captures with the board 2 to 6 m away, in different places, tilted by 20 to 45 degrees to all "
    "sides.";

std::string PairOf(const LidarCameraProblem& problem) {
  return problem.camera.id.str() + " and " + problem.lidar.id.str();
}

std::string BoardOf(const LidarCameraProblem& problem) { return "target '" + problem.board.id.str() + "'"; }

std::string CapturesText(std::size_t count) { return std::to_string(count) + (count == 1 ? " capture" : " captures"); }
std::string OnlyCapturesText(std::size_t count) { return count == 0 ? "no capture" : "only " + CapturesText(count); }

std::string Formatted(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

template <typename WhyNot>
std::string FirstReason(const LidarCameraProblem& problem, const CaptureId& first, const WhyNot& why_not) {
  for (const LidarCameraCapture& capture : problem.captures)
    if (capture.capture == first)
      if (const std::string why = why_not(capture); !why.empty())
        return " The first of them: " + why + (why.back() == '.' ? "" : ".");
  return {};
}

std::string SpreadText(double cone_deg, double sigma_m) {
  return "the boards' normals differ by at most " + Formatted("%.0f", cone_deg) +
         " degrees or lie in one plane: with planes known to 10 mm the translation would be uncertain by " +
         (sigma_m < 10 ? MillimetresText(sigma_m) : std::string("metres"));
}

}  // namespace

std::string MillimetresText(double value_m) { return Formatted("%.0f mm", 1e3 * value_m); }
std::string DegreesText(double value_rad) { return Formatted("%.1f deg", value_rad * 180 / M_PI); }

Diagnosis TooFewLidarCaptures(const LidarCameraProblem& problem, std::size_t both) {
  return {"too_few_captures",
          PairOf(problem) + " see " + BoardOf(problem) + " together in " + OnlyCapturesText(both) + "; at least " +
              std::to_string(kLidarCapturesMin) + " are needed.",
          kTakeMore};
}

Diagnosis FewLidarCaptures(const LidarCameraProblem& problem, std::size_t used) {
  return {"few_captures",
          PairOf(problem) + " see " + BoardOf(problem) + " together in only " + CapturesText(used) +
              "; with fewer than " + std::to_string(kLidarCapturesEnough) + " the uncertainty itself is rough.",
          kTakeMore};
}

Diagnosis BoardNotInPictures(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {"board_not_found",
          problem.camera.id.str() + " does not show " + BoardOf(problem) + " in " + CapturesText(captures.size()) +
              ": " + NamesOf(captures) + "." +
              FirstReason(problem, captures.front(),
                          [](const LidarCameraCapture& capture) {
                            return capture.view ? capture.view->why_not : std::string("there is no picture");
                          }),
          "Show the whole board, sharp and evenly lit, and check its description in session.yaml."};
}

Diagnosis BoardNotInClouds(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {
      "board_not_found_in_cloud",
      problem.lidar.id.str() + " does not show " + BoardOf(problem) + " in " + CapturesText(captures.size()) + ": " +
          NamesOf(captures) + "." +
          FirstReason(problem, captures.front(),
                      [](const LidarCameraCapture& capture) {
                        return capture.cloud ? capture.cloud->why_not : std::string("there is no cloud");
                      }),
      "Hold the board free of walls and furniture, near enough for several beams to cross it, and check plate_size_m "
      "in session.yaml."};
}

Diagnosis PicturesUnreadable(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return Unreadable(problem.camera.id, captures,
                    FirstReason(problem, captures.front(), [](const auto& capture) { return capture.view->why_not; }));
}

Diagnosis CloudsUnreadable(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {"cloud_unreadable",
          std::to_string(captures.size()) + (captures.size() == 1 ? " cloud of " : " clouds of ") +
              problem.lidar.id.str() + " cannot be read and take no part: " + NamesOf(captures) + "." +
              FirstReason(problem, captures.front(), [](const auto& capture) { return capture.cloud->why_not; }),
          "Copy the files again from where they were recorded, or take those captures again."};
}

Diagnosis NoAgreement(const LidarCameraProblem& problem, std::size_t both, std::size_t supporters) {
  return {
      "no_agreement",
      "no pose of " + problem.lidar.id.str() + " puts a patch of the cloud where " + problem.camera.id.str() +
          " sees " + BoardOf(problem) + " in more than " + std::to_string(supporters) + " of " + CapturesText(both) +
          ".",
      "Check plate_size_m and square_size_m, that pictures and clouds of one name were taken together, and that the "
      "board stood still."};
}

Diagnosis AmbiguousBoard(const LidarCameraProblem& problem, std::size_t supporters, std::size_t others) {
  return {"ambiguous_board",
          BoardOf(problem) + " could be two different things in the clouds of " + problem.lidar.id.str() +
              ": one pose agrees with " + CapturesText(supporters) + ", another with " + std::to_string(others) + ".",
          "Give nominal poses of both sensors in session.yaml, or take captures in more places and tilts."};
}

Diagnosis NoNormalSpread(const LidarCameraProblem& problem, double cone_deg, double sigma_m) {
  return {"no_normal_spread", PairOf(problem) + ": " + SpreadText(cone_deg, sigma_m) + ".",
          "Tilt the board by 20 to 45 degrees, to the left and right as well as up and down, and take more captures."};
}

Diagnosis NormalsInOnePlane(const LidarCameraProblem& problem, const Eigen::Vector3d& axis_cam) {
  Eigen::Index largest = 0;
  axis_cam.cwiseAbs().maxCoeff(&largest);
  const Eigen::Vector3d axis = axis_cam[largest] < 0 ? Eigen::Vector3d(-axis_cam) : axis_cam;
  char text[64];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", axis.x() + 0.0, axis.y() + 0.0, axis.z() + 0.0);
  return {"normals_in_one_plane",
          PairOf(problem) + ": the normals of all boards lie in one plane or nearly so, so that nothing tells where " +
              problem.lidar.id.str() + " is along " + text + " in the frame of " + problem.camera.id.str() +
              ". It is near where the nominal poses or the boards' middles have it, and nothing is claimed there.",
          "Tilt the board by 20 to 45 degrees up and down as well, or tilt the robot, and take more captures."};
}

Diagnosis WeakNormalSpread(const LidarCameraProblem& problem, double cone_deg, double sigma_m) {
  return {"weak_normal_spread", PairOf(problem) + ": " + SpreadText(cone_deg, sigma_m) + ".",
          "Add captures with the board tilted by 20 to 45 degrees, to the left and right as well as up and down."};
}

Diagnosis ContradictingClouds(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {"inconsistent_captures",
          PairOf(problem) + ": picture and cloud of " + CapturesText(captures.size()) +
              " contradict the others and were left out: " + NamesOf(captures) + ".",
          "Check that the board stood still and that pictures and clouds of one name were taken together."};
}

Diagnosis HighLidarResidual(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  return {"high_residual",
          PairOf(problem) + ": the boards in picture and cloud are apart by " + MillimetresText(estimate.rms_m) +
              " and " + DegreesText(estimate.rms_rad) + " (rms), more than " + MillimetresText(kHighRms_m) + " or " +
              DegreesText(kHighRms_rad) + ".",
          "Check the board's size in session.yaml and the camera's intrinsics, and that the board is flat and stood "
          "still."};
}

Diagnosis RangeBiasSuspected(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const double bias_m = estimate.range_bias_m;
  return {"range_bias_suspected",
          problem.lidar.id.str() + " seems to measure all distances " + MillimetresText(std::abs(bias_m)) +
              (bias_m > 0 ? " too short" : " too long") + " (+- " + MillimetresText(estimate.range_bias_sigma_m) +
              "). It is not corrected; what it would change is part of the uncertainty.",
          "Check square_size_m, then compare the lidar with a tape measure against a flat wall, and correct its ranges "
          "in its driver."};
}

Diagnosis RangeTakenAsExact(const LidarCameraProblem& problem) {
  return {"range_taken_as_exact",
          "The ranges of " + problem.lidar.id.str() + " are taken as free of an error that all of them share.",
          "Give range_bias_sigma_m in session.yaml, such as the range accuracy of its data sheet, and it becomes part "
          "of the "
          "uncertainty."};
}

Diagnosis TooFewForIntrinsics(const LidarCameraProblem& problem, std::size_t views) {
  return {"too_few_captures",
          problem.camera.id.str() + " has no given intrinsics and shows " + BoardOf(problem) + " in only " +
              CapturesText(views) + "; at least " + std::to_string(kLidarViewsForIntrinsics) +
              " are needed to estimate them beside the lidar's pose.",
          "Take more captures, or give the camera's intrinsics in session.yaml."};
}

Diagnosis CapturesDisagree(const LidarCameraProblem& problem, const std::vector<CaptureId>& captures) {
  return {"captures_disagree",
          "The picture of " + problem.camera.id.str() + " and the cloud of " + problem.lidar.id.str() +
              " do not show the board in the same place in " + CapturesText(captures.size()) + ": " +
              NamesOf(captures) + ".",
          "Check that the names of these files were not exchanged, and that the board stood still and free."};
}

Diagnosis BoardSizeSuspected(const LidarCameraProblem& problem, const LidarCameraEstimate& estimate) {
  const double fitted_m = problem.board.square_m * (1 + estimate.board_scale_ratio);
  return {"board_size_suspected",
          "The size of " + BoardOf(problem) + " seems to be " +
              Formatted("%.2f", 100 * std::abs(estimate.board_scale_ratio)) + " % " +
              (estimate.board_scale_ratio > 0 ? "larger" : "smaller") + " than given: picture and cloud agree with " +
              Formatted("%.2f", 1e3 * fitted_m) + " mm (+- " +
              Formatted("%.2f", 1e3 * problem.board.square_m * estimate.board_scale_sigma_ratio) + ") instead of " +
              Formatted("%.2f", 1e3 * problem.board.square_m) + " mm.",
          "Measure the board across many squares and correct its size in session.yaml; if it is right, the camera's "
          "focal length or "
          "the lidar's scale is wrong."};
}

Diagnosis BoardSizeTakenAsExact(const LidarCameraProblem& problem) {
  return {"board_size_taken_as_exact", "The size of " + BoardOf(problem) + " is taken as exact.",
          "Give its standard deviation in session.yaml (square_size_sigma_m or tag_size_sigma_m): 0.3 % move a lidar "
          "at 4 m by a "
          "centimetre."};
}

Diagnosis NotSolvable(const LidarCameraProblem& problem, const Error& error) {
  const std::string pair = PairOf(problem) + ": ";
  const bool names_it = error.what.starts_with(pair);  // of a solve without a capture, say: a diagnosis of its own
  return {"ill_conditioned", names_it ? error.what : pair + error.what + ".", error.cure};
}

}  // namespace rigcal::calib
