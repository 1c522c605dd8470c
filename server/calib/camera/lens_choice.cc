#include "server/calib/camera/lens_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/calib/camera/focal_trials.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/robust.h"
#include "server/calib/core/selection.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kViewsTried = 30;
constexpr double kClearlyBetterRatio = 0.5, kAlikeRatio = 1.1;
// Of those that fit alike the one that only adds terms to the camera's own, then those with fewer ways to go wrong.
constexpr std::array kLenses = {CameraModel::kPinholeRadtan, CameraModel::kFisheyeKb4, CameraModel::kPinholeRational};
constexpr std::array kLensCodes = {"high_residual",  "ill_conditioned",           "no_convergence",
                                   "no_intrinsics",  "distortion_not_observable", "too_few_captures",
                                   "no_common_view", "inconsistent_captures",     "ambiguous_pose"};
constexpr const char *kNoTiltCode = "no_tilt", *kNoStartCode = "no_intrinsics",
                     *kSuspectedCode = "lens_model_suspected";

std::string PixelsText(double value_px) { return Formatted("%.2f px", value_px); }

CameraProblem SomeViews(const CameraProblem& problem) {
  CameraProblem some{problem.camera, problem.board, {}};
  for (const auto& view : problem.views)
    if (WhyUnusable(view.second, problem.board).empty()) some.views.push_back(view);
  some.views = SpreadOver(some.views, kViewsTried);
  return some;
}

// Infinite: it does not fit.
double RmsOf_px(const CameraProblem& problem, CameraModel model) {
  const auto estimate = EstimateCameraAs(problem, model);
  return estimate ? estimate->rms_px : std::numeric_limits<double>::infinity();
}

// Refused or not. Boards that are not tilted fit a lens of their own with almost any focal length: one that they do not
// fit with any is not theirs, and how they are tilted cannot be told by it. Zero: nothing can be held against it.
double OwnRmsOf_px(const CameraProblem& problem, CameraModel own) {
  const auto estimate = EstimateCameraAs(problem, own);
  if (estimate) return estimate->rms_px;
  const std::string& code = estimate.error().code;
  if (code != kNoTiltCode && code != kNoStartCode) return FitRms_px(problem, own);
  const double least_px = LeastRmsOverFocals_px(ViewsOf(problem));
  return std::isfinite(least_px) || code == kNoStartCode ? least_px : 0.0;
}

std::string FigureOf(const BetterLens& lens, const std::string& side) {
  return "rms_as_" + NameOf(lens.model) + side + "_px";
}

std::string CureOf(const BetterLens& lens) {
  return Worded("Give {} 'model: {}' in session.yaml: by itself it fits its corners to {} rms with it{}.",
                {lens.camera, NameOf(lens.model), PixelsText(lens.rms_px),
                 std::isfinite(lens.own_rms_px) ? ", not to " + PixelsText(lens.own_rms_px) : ""});
}

bool AddsTermsTo(CameraModel own, CameraModel model) {
  return own == CameraModel::kPinholeRadtan && model == CameraModel::kPinholeRational;
}

BetterLens Chosen(const std::vector<BetterLens>& others, double least_px, CameraModel own) {
  const auto fits = [&](const BetterLens& lens) { return lens.rms_px <= kAlikeRatio * least_px; };
  const auto adding = std::find_if(others.begin(), others.end(),
                                   [&](const BetterLens& lens) { return fits(lens) && AddsTermsTo(own, lens.model); });
  return adding != others.end() ? *adding : *std::find_if(others.begin(), others.end(), fits);
}

}  // namespace

double HighRms_px(int width_px) { return std::max(1.0, kHighRmsRatio * width_px); }

std::optional<BetterLens> FindBetterLens(const CameraProblem& problem) {
  if (problem.camera.intrinsics) return std::nullopt;
  const CameraProblem tried = SomeViews(problem);
  if (tried.views.empty()) return std::nullopt;
  const CameraModel own = problem.camera.camera_model;
  std::vector<BetterLens> others;
  double least_px = std::numeric_limits<double>::infinity();
  for (const CameraModel model : kLenses) {
    if (model == own) continue;
    others.push_back({problem.camera.id, model, RmsOf_px(tried, model)});
    least_px = std::min(least_px, others.back().rms_px);
  }
  const double high_px = HighRms_px(tried.views.front().second.image_width_px), own_px = OwnRmsOf_px(tried, own);
  if (!(least_px <= kClearlyBetterRatio * std::min(own_px, high_px))) return std::nullopt;
  BetterLens chosen = Chosen(others, least_px, own);
  chosen.own_rms_px = own_px;
  return chosen;
}

Diagnosis WithLensAsCure(Diagnosis diagnosis, const std::map<std::string, CameraProblem>& cameras) {
  if (std::find(kLensCodes.begin(), kLensCodes.end(), diagnosis.code) == kLensCodes.end()) return diagnosis;
  std::string cure;
  for (const auto& [side, camera] : cameras) {
    const auto lens = FindBetterLens(camera);
    if (!lens) continue;
    cure += (cure.empty() ? "" : " ") + CureOf(*lens);
    diagnosis.figures[FigureOf(*lens, side)] = lens->rms_px;
  }
  if (!cure.empty()) diagnosis.cure = std::move(cure);
  return diagnosis;
}

Diagnosis TiltOrLens(const CameraProblem& problem, Diagnosis diagnosis) {
  const auto lens = diagnosis.code == kNoTiltCode ? FindBetterLens(problem) : std::nullopt;
  if (!lens) return diagnosis;
  return {kSuspectedCode,
          Worded("The lens of {} is not {}: another model fits its corners better, so how the boards were tilted "
                 "cannot be told by this one.",
                 {problem.camera.id, NameOf(problem.camera.camera_model)}),
          CureOf(*lens),
          {{FigureOf(*lens, ""), lens->rms_px}}};
}

Diagnosis LensSuspected(const CameraProblem& problem, double rms_px, const BetterLens& lens) {
  return {kSuspectedCode,
          Worded("{} fits its corners to {} rms with the lens model {}; another one fits them better.",
                 {problem.camera.id, PixelsText(rms_px), NameOf(problem.camera.camera_model)}),
          CureOf(lens)};
}

}  // namespace rigcal::calib
