// Over a camera's picture: how far off a point may be projected, by the covariance of the intrinsics.
#pragma once

#include "server/report/cameras/camera_choice.h"
#include "server/report/frame/page.h"

namespace rigcal::report {

// UNCERTAINTY with a map for a far point and one for a near one; NO_UNCERTAINTY with a sentence where there is none.
// Neither of a camera that was not solved.
void FillUncertainty(Dictionary& section, const CameraReport& camera);

}  // namespace rigcal::report
