// How well a lens model can fit views that do not tell its focal length.
#pragma once

#include "server/calib/camera/camera_start.h"

namespace rigcal::calib {

// The least rms over focal lengths of views of 10 to 150 degrees that are held in turn, the rest refined: boards that
// are not tilted fit about equally with all of them. Infinite where no minimum is reached, or a view has no pose.
[[nodiscard]] double LeastRmsOverFocals_px(const CameraViews& views);

}  // namespace rigcal::calib
