#include "server/calib/camera/lens_choice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/calib/camera/lens_bounds.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/diagnoses.h"
#include "server/calib/core/robust.h"
#include "server/calib/core/selection.h"
#include "server/calib/planes/planar_pose.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kLensViewsTried = 30;
constexpr double kClearlyBetterRatio = 0.5, kAlikeRatio = 1.1;
// Of those that fit alike the one that only adds terms to the camera's own, then those with fewer ways to go wrong.
constexpr std::array kLenses = {CameraModel::kPinholeRadtan, CameraModel::kFisheyeKb4, CameraModel::kPinholeRational};
constexpr std::array kLensCodes = {
    "high_residual",    "ill_conditioned", "no_convergence",        "no_intrinsics",  "distortion_not_observable",
    "too_few_captures", "no_common_view",  "inconsistent_captures", "ambiguous_pose", kAbsurdDistortionCode};
constexpr const char *kNoTiltCode = "no_tilt", *kNoStartCode = "no_intrinsics",
                     *kSuspectedCode = "lens_model_suspected";

std::string PixelsText(double value_px) { return Formatted("%.2f px", value_px); }

CameraProblem SomeViews(const CameraProblem& problem) {
  CameraProblem some{problem.camera, problem.board, {}};
  for (const auto& view : problem.views)
    if (WhyUnusable(view.second, problem.board).empty()) some.views.push_back(view);
  some.views = SpreadOver(some.views, kLensViewsTried);
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

// Of the camera's own model, too, as far as it fits at all.
void NoteFit(const BetterLens& lens, const std::string& side, std::map<std::string, double>& figures) {
  figures["rms_as_" + NameOf(lens.model) + side + "_px"] = lens.rms_px;
  if (std::isfinite(lens.own_rms_px) && lens.own_rms_px > 0) figures["rms_as_listed" + side + "_px"] = lens.own_rms_px;
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
    NoteFit(*lens, side, diagnosis.figures);
  }
  if (!cure.empty()) diagnosis.cure = std::move(cure);
  return diagnosis;
}

Diagnosis TiltOrLens(const CameraProblem& problem, Diagnosis diagnosis) {
  const auto lens = diagnosis.code == kNoTiltCode ? FindBetterLens(problem) : std::nullopt;
  if (!lens) return diagnosis;
  Diagnosis told{kSuspectedCode,
                 Worded("The lens of {} is not {}: another model fits its corners better, so how the boards were "
                        "tilted cannot be told by this one.",
                        {problem.camera.id, NameOf(problem.camera.camera_model)}),
                 CureOf(*lens)};
  NoteFit(*lens, "", told.figures);
  return told;
}

Diagnosis LensSuspected(const CameraProblem& problem, double rms_px, const BetterLens& lens) {
  return {kSuspectedCode,
          Worded("{} fits its corners to {} rms with the lens model {}; another one fits them better.",
                 {problem.camera.id, PixelsText(rms_px), NameOf(problem.camera.camera_model)}),
          CureOf(lens)};
}

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr std::array<double, 9> kFocals_ratio = {0.15, 0.24, 0.38, 0.6, 0.95,
                                                 1.5,  2.4,  3.8,  6.0};  // of the longer side
constexpr double kStep_ratio = 1.6;
constexpr int kHalvings = 3;  // of the logarithm of that step, to both sides of the best
constexpr std::size_t kViewsOfTrial = 12;
constexpr int kRounds = 2;  // poses of boards are chosen anew once the distortion is known

bool PlaceAll(const JointProblem& joint, JointState& state) {
  state.T_a_board.resize(joint.captures.size());
  for (std::size_t k = 0; k < joint.captures.size(); ++k) {
    const PoseChoice choice = ChoosePose(joint, state, k, AllowedPoses(joint, state, k));
    if (!std::isfinite(choice.ssr_px2)) return false;
    state.T_a_board[k] = choice.T_a_board;
  }
  return true;
}

double RmsAtFocal_px(const CameraViews& views, double focal_px) {
  JointProblem joint = OneCamera(views, true);
  joint.a.held = {0};  // the other one follows: pixels need not be square
  JointState state;
  state.intrinsics_a = PlainLens(views.model, focal_px, views.width_px, views.height_px);
  double least_px = kNone;
  for (int round = 0; round < kRounds && PlaceAll(joint, state); ++round) {
    auto solved = SolveJoint(joint, state);
    if (!solved) break;
    state = std::move(solved->state);
    least_px = std::min(least_px, std::sqrt(2 * SumOfSquares_px2(joint, state) / ResidualCount(joint)));
  }
  return least_px;
}

}  // namespace

double LeastRmsOverFocals_px(const CameraViews& views) {
  const CameraViews tried = Spread(views, kViewsOfTrial);
  double least_px = kNone, best_px = 0;
  const auto look = [&](double focal_px) {
    const double rms_px = RmsAtFocal_px(tried, focal_px);
    if (rms_px < least_px) least_px = rms_px, best_px = focal_px;
  };
  for (const double ratio : kFocals_ratio) look(ratio * std::max(views.width_px, views.height_px));
  double step_ratio = kStep_ratio;
  for (int halving = 0; halving < kHalvings && std::isfinite(least_px); ++halving) {
    step_ratio = std::sqrt(step_ratio);
    const double middle_px = best_px;
    look(middle_px / step_ratio);
    look(middle_px * step_ratio);
  }
  return least_px;
}

}  // namespace rigcal::calib
