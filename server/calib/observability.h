// How well the focal length of a camera can be known from its views, before anything is solved.
#pragma once

#include "server/calib/camera_start.h"

namespace rigcal::calib {

struct FocalOutlook {
  double sigma_ratio = 0;  // predicted sigma of the focal length over the focal length; infinite: not observable
  double spread_deg = 0;   // largest angle between the normals of two boards
};
[[nodiscard]] FocalOutlook PredictFocal(const CameraViews& views);

}  // namespace rigcal::calib
