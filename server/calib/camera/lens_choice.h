// Whether another lens model explains what a camera's own does not.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>

#include "server/calib/camera/camera_start.h"
#include "server/calib/camera/intrinsics.h"

namespace rigcal::calib {

// The same views with intrinsics of `model`, from scratch.
[[nodiscard]] OrDiagnosis<CameraEstimate> EstimateCameraAs(const CameraProblem& problem, CameraModel model);

// To which they then fit, refused or not; infinite where no minimum is reached.
[[nodiscard]] double FitRms_px(const CameraProblem& problem, CameraModel model);

// An rms beyond this is refused.
[[nodiscard]] double HighRms_px(int width_px);

struct BetterLens {
  SensorId camera;
  CameraModel model = CameraModel::kPinholeRadtan;
  double rms_px = 0;  // to which the camera by itself fits its corners with it
  double own_rms_px = std::numeric_limits<double>::infinity();  // with its own model
};

// Tries the other models on some of the camera's views. Nothing where intrinsics are given, where its own model fits
// them within twice the residual, or where none fits them to half the residual that is refused. Where boards are not
// tilted enough to tell a focal length by the camera's own model, this one may have any.
[[nodiscard]] std::optional<BetterLens> FindBetterLens(const CameraProblem& problem);
// "high_residual", "ill_conditioned" and the like are also what a wrong lens gives: where another one fits, it is the
// cure, and "rms_as_fisheye_kb4_a_px" the figure, beside "rms_as_listed_a_px" of its own model. Cameras by their side
// of a pair, "_a" and "_b", or one alone by "". Other diagnoses stay as they are.
[[nodiscard]] Diagnosis WithLensAsCure(Diagnosis diagnosis, const std::map<std::string, CameraProblem>& cameras);
// Boards look less tilted through a wrong lens than they are: "no_tilt" becomes "lens_model_suspected", with the figure
// "rms_as_fisheye_kb4_px" (and "rms_as_listed_px"), where another model fits. Other diagnoses stay as they are.
[[nodiscard]] Diagnosis TiltOrLens(const CameraProblem& problem, Diagnosis diagnosis);
// "lens_model_suspected": a note on a good edge of a camera that fits its corners to `rms_px`.
[[nodiscard]] Diagnosis LensSuspected(const CameraProblem& problem, double rms_px, const BetterLens& lens);

// How well a lens model can fit views that do not tell its focal length: the least rms over focal lengths of views of
// 10 to 150 degrees that are held in turn, the rest refined: boards that are not tilted fit about equally with all of
// them. Infinite where no minimum is reached, or a view has no pose.
[[nodiscard]] double LeastRmsOverFocals_px(const CameraViews& views);

}  // namespace rigcal::calib
