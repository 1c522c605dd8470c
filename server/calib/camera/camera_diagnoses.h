// The sentences about one camera by itself, and about a charuco board whose layout is described wrong.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/result.h"
#include "server/calib/camera/intrinsics.h"
#include "server/model/diagnosis.h"
#include "server/model/sensors/board_layout.h"
#include "server/model/sensors/target.h"

namespace rigcal::calib {

// `why`: of the first view that cannot be used, or empty.
[[nodiscard]] Diagnosis TooFewViews(const CameraProblem& problem, std::size_t usable, std::size_t needed,
                                    const std::string& why);
[[nodiscard]] Diagnosis CameraHighResidual(const CameraProblem& problem, double rms_px, double limit_px);
[[nodiscard]] Diagnosis CameraIllConditioned(const SensorId& camera, const std::string& why);
// The distortion of an estimated camera is not told by its views. `name` as in DistortionNames().
[[nodiscard]] Diagnosis DistortionOpen(const SensorId& camera, CameraModel model, const std::string& name);

// A note on a good edge: the views put refined intrinsics further than six sigmas from where they were given.
[[nodiscard]] std::optional<Diagnosis> WhyGivenDisagree(const Sensor& camera, const CameraIntrinsics& refined);

// "board_layout": the pictures of these captures show it (ShowsOtherLayout).
[[nodiscard]] Diagnosis OtherLayout(const SensorId& camera, const Target& board,
                                    const std::vector<CaptureId>& captures);
// Of a failed edge: a board that is described wrong comes before everything that follows from it.
void PutLayoutFirst(std::vector<Diagnosis>& diagnoses);

}  // namespace rigcal::calib
