#include "server/calib/camera/camera_diagnoses.h"

#include <algorithm>
#include <cmath>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/core/wording.h"

namespace rigcal::calib {
namespace {

constexpr double kDisagreeingSigmas = 6.0;
constexpr const char* kLayoutCode = "board_layout";

std::string NameOfIntrinsic(CameraModel model, int idx) {
  static const char* const kFirst[] = {"fx", "fy", "cx", "cy"};
  return idx < 4 ? kFirst[idx] : DistortionNames(model)[static_cast<std::size_t>(idx) - 4];
}

// "in only 2 of 9 captures"; nothing is only of nothing.
std::string SeenText(std::size_t usable, std::size_t views) {
  if (views == 0) return "in no capture: none has a usable picture of it";
  if (usable == 0) return "in none of " + CountText(views);
  return Worded("in only {} of {}", {usable, CountText(views)});
}

}  // namespace

Diagnosis TooFewViews(const CameraProblem& problem, std::size_t usable, std::size_t needed, const std::string& why) {
  return {"too_few_captures",
          Worded("{} sees target '{}' {}; at least {} {} needed.{}",
                 {problem.camera.id, problem.board.id, SeenText(usable, problem.views.size()), needed,
                  needed == 1 ? "is" : "are", why.empty() ? "" : " The first of the others: " + why + "."}),
          "Take 10 to 20 captures that show the board sharp and evenly lit, tilted in different directions."};
}

Diagnosis CameraHighResidual(const CameraProblem& problem, double rms_px, double limit_px) {
  return {
      "high_residual",
      Worded("{} fits the corners of target '{}' to {} px rms, more than {} px.",
             {problem.camera.id, problem.board.id, Formatted("%.2f", rms_px), Formatted("%.2f", limit_px)}),
      "Check that the board is flat, that its counts and square size are right, and that given intrinsics belong to "
      "this camera and name its model."};
}

Diagnosis CameraIllConditioned(const SensorId& camera, const std::string& why) {
  return {"ill_conditioned", Worded("{}: its intrinsics have no usable uncertainty ({}).", {camera, why}),
          "Take more captures with the board tilted in different directions, near and far, in all corners."};
}

Diagnosis DistortionOpen(const SensorId& camera, CameraModel model, const std::string& name) {
  return {"distortion_not_observable",
          Worded("The views of {} do not tell the distortion {} of the model {}.", {camera, name, NameOf(model)}),
          "Take captures with the board in all corners of the picture."};
}

std::optional<Diagnosis> WhyGivenDisagree(const Sensor& camera, const CameraIntrinsics& refined) {
  double most = 0;
  int worst = 0;
  for (const int i : RefinedOf(camera)) {
    const double away = VectorOf(refined)[i] - VectorOf(*camera.intrinsics)[i];
    const double sigmas = std::abs(away) / (*camera.intrinsics_sigma)[static_cast<std::size_t>(i)];
    if (sigmas > most) most = sigmas, worst = i;
  }
  if (!(most > kDisagreeingSigmas)) return std::nullopt;
  return Diagnosis{
      "given_intrinsics_disagree",
      Worded("The pictures of {} put {} {} sigmas from where it was given.",
             {camera.id, NameOfIntrinsic(refined.model, worst), Formatted("%.2f", most)}),
      "Calibrate this camera anew, give a larger 'sigma' with its intrinsics in session.yaml, or leave them "
      "out to have them estimated."};
}

Diagnosis OtherLayout(const SensorId& camera, const Target& board, const std::vector<CaptureId>& captures) {
  return {kLayoutCode,
          Worded("In {} of {} ({}) the markers of target '{}' lie as in the layout {}, which is not the one of its "
                 "description; these pictures take no part.",
                 {CountText(captures.size()), camera, NamesOf(captures), board.id,
                  board.legacy_layout ? "of OpenCV 4.6 and later" : "before OpenCV 4.6 (legacy)"}),
          Worded("Set legacy_layout: {} for target '{}' in session.yaml, and push the session again.",
                 {board.legacy_layout ? "false" : "true", board.id})};
}

void PutLayoutFirst(std::vector<Diagnosis>& diagnoses) {
  std::stable_partition(diagnoses.begin(), diagnoses.end(),
                        [](const Diagnosis& diagnosis) { return diagnosis.code == kLayoutCode; });
}

}  // namespace rigcal::calib
