// Distortion that no lens has, within the part of the picture where corners were seen.
#pragma once

#include <optional>
#include <string>

#include "server/calib/camera/camera_start.h"
#include "server/model/diagnosis.h"
#include "server/model/sessions/session.h"

namespace rigcal::calib {

inline constexpr const char* kAbsurdDistortionCode = "absurd_distortion";

// "absurd_distortion": a sphere model's number is none that its lenses have; `why`: what WhyNoSphere says. Of an
// estimated eucm lens with an alpha below 0 the cure is the model that bends so little.
[[nodiscard]] Diagnosis NoSphereLens(const SensorId& camera, bool is_given, const CameraIntrinsics& lens,
                                     const std::string& why);
// "absurd_distortion": the lens turns over before the outermost corner of a tenth of the views, of two at least; or,
// a sphere model's number is none that its lenses have (WhyNoSphere); or,
// somewhere up to the outermost corner that a ray leads to, it images a ray less than half as far out as an
// orthographic lens does (the sine of the angle to the axis), more than 1.5 times as far out as a rectilinear one (the
// tangent), or grows 2.5 times as fast as that; or it was estimated, and its p1 and p2 are those of a sensor that is
// tilted by more than 3 deg against its lens. Never for what lies beyond the corners seen. `intrinsics` of the model
// of `views`; those of `camera` say whether they were given.
[[nodiscard]] std::optional<Diagnosis> WhyAbsurd(const Sensor& camera, const IntrinsicsVector& intrinsics,
                                                 const CameraViews& views);

}  // namespace rigcal::calib
