// The picture of a cloud and the plates found in it, for reports.
#pragma once

#include <string>
#include <vector>

#include "server/detect/clouds/plate_fit.h"

namespace rigcal::detect {

// JPEG, at most 1280 px wide: the cloud as the sensor sees it (azimuth across, elevation up; near is bright), plates
// outlined and numbered, the first in a signal colour; `points` of the whole cloud for its caption. The same input
// gives the same bytes. Throws what OpenCV throws.
[[nodiscard]] std::string CloudPicture(const CloudRays& rays, std::size_t points,
                                       const std::vector<FittedPlate>& plates);

}  // namespace rigcal::detect
