// Finds the plate of a calibration board in a whole lidar scan.
#pragma once

#include <string>

#include "server/model/sensors/cloud.h"
#include "server/model/sensors/features.h"
#include "server/model/sensors/target.h"

namespace rigcal::detect {

constexpr std::size_t kPatchesMax = 8;

// Names algorithm, version and plate: the key of the cache.
[[nodiscard]] std::string CloudDetectorKey(const Target& target);
// Every flat patch of the cloud that may be the target's plate, best first, at most kPatchesMax. What is wrong is
// view.why_not; of a search that broke off, view.points is 0: nothing to keep. Throws std::bad_alloc. Pure: the same
// cloud gives the same patches and picture. Any 3D lidar; rings need not be known.
[[nodiscard]] AnnotatedCloud DetectPlate(const Cloud& cloud, const Target& target);

}  // namespace rigcal::detect
