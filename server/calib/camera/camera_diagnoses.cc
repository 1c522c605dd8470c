#include "server/calib/camera/camera_diagnoses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/core/diagnoses.h"

namespace rigcal::calib {
namespace {

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", value);
  return text;
}

constexpr double kDisagreeingSigmas = 6.0;

std::string NameOfIntrinsic(CameraModel model, int idx) {
  static const char* const kFirst[] = {"fx", "fy", "cx", "cy"};
  return idx < 4 ? kFirst[idx] : DistortionNames(model)[static_cast<std::size_t>(idx) - 4];
}

// "in only 2 of 9 captures"; nothing is only of nothing.
std::string SeenText(std::size_t usable, std::size_t views) {
  if (views == 0) return "in no capture: none has a usable picture of it";
  if (usable == 0) return "in none of " + std::to_string(views) + (views == 1 ? " capture" : " captures");
  return "in only " + std::to_string(usable) + " of " + std::to_string(views) + (views == 1 ? " capture" : " captures");
}

constexpr const char* kLayoutCode = "board_layout";

}  // namespace

Diagnosis TooFewViews(const CameraProblem& problem, std::size_t usable, std::size_t needed, const std::string& why) {
  return {"too_few_captures",
          problem.camera.id.str() + " sees target '" + problem.board.id.str() + "' " +
              SeenText(usable, problem.views.size()) + "; at least " + std::to_string(needed) + " are needed." +
              (why.empty() ? "" : " The first of the others: " + why + "."),
          "Take 10 to 20 captures that show the board sharp and evenly lit, tilted in different directions."};
}

Diagnosis CameraHighResidual(const CameraProblem& problem, double rms_px, double limit_px) {
  return {
      "high_residual",
      problem.camera.id.str() + " fits the corners of target '" + problem.board.id.str() + "' to " + Number(rms_px) +
          " px rms, more than " + Number(limit_px) + " px.",
      "Check that the board is flat, that its counts and square size are right, and that given intrinsics belong to "
      "this camera and name its model."};
}

Diagnosis CameraIllConditioned(const SensorId& camera, const std::string& why) {
  return {"ill_conditioned", camera.str() + ": its intrinsics have no usable uncertainty (" + why + ").",
          "Take more captures with the board tilted in different directions, near and far, in all corners."};
}

Diagnosis DistortionOpen(const SensorId& camera, CameraModel model, const std::string& name) {
  return {
      "distortion_not_observable",
      "The views of " + camera.str() + " do not tell the distortion " + name + " of the model " + NameOf(model) + ".",
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
      "The pictures of " + camera.id.str() + " put " + NameOfIntrinsic(refined.model, worst) + " " + Number(most) +
          " sigmas from where it was given.",
      "Calibrate this camera anew, give a larger 'sigma' with its intrinsics in session.yaml, or leave them "
      "out to have them estimated."};
}

Diagnosis CameraError(const SensorId& camera, const std::string& code, const Error& error) {
  return {code, camera.str() + ": " + error.what + ".", error.cure};
}

Diagnosis OtherLayout(const SensorId& camera, const Target& board, const std::vector<CaptureId>& captures) {
  return {kLayoutCode,
          "In " + std::to_string(captures.size()) + (captures.size() == 1 ? " capture of " : " captures of ") +
              camera.str() + " (" + NamesOf(captures) + ") the markers of target '" + board.id.str() +
              "' lie as in the layout " +
              (board.legacy_layout ? "of OpenCV 4.6 and later" : "before OpenCV 4.6 (legacy)") +
              ", which is not the one of its description; these pictures take no part.",
          std::string("Set legacy_layout: ") + (board.legacy_layout ? "false" : "true") + " for target '" +
              board.id.str() + "' in session.yaml, and push the session again."};
}

void PutLayoutFirst(std::vector<Diagnosis>& diagnoses) {
  std::stable_partition(diagnoses.begin(), diagnoses.end(),
                        [](const Diagnosis& diagnosis) { return diagnosis.code == kLayoutCode; });
}

}  // namespace rigcal::calib
