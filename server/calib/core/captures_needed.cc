#include "server/calib/core/captures_needed.h"

#include "server/calib/core/diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"

namespace rigcal::calib {

static_assert(RowOf(Method::kStereo).captures_least == kCapturesMin);
static_assert(RowOf(Method::kLidarCamera).captures_least == kLidarCapturesMin);
static_assert(RowOf(Method::kTrackerLidar).captures_least == kTrackerLidarMin);
static_assert(RowOf(Method::kNonOverlapping).captures_least == kHandEyeMin);
static_assert(RowOf(Method::kTrackerCamera).captures_least == kHandEyeMin);

CapturesNeeded NeededBy(Method method) {
  const std::size_t least = RowOf(method).captures_least;
  switch (method) {
    case Method::kStereo: return {least, kCapturesEnough};
    case Method::kLidarCamera: return {least, kLidarCapturesEnough};
    case Method::kLidarLidar: return {least, kCloudsEnough};
    case Method::kTrackerLidar: return {least, kTrackerLidarEnough};
    case Method::kNonOverlapping:
    case Method::kTrackerCamera: return {least, kHandEyeEnough};
    case Method::kPoseStreams: return {};
  }
  return {};
}

}  // namespace rigcal::calib
