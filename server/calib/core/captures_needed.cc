#include "server/calib/core/captures_needed.h"

#include "server/calib/core/diagnoses.h"
#include "server/calib/lidar_camera/lidar_camera_diagnoses.h"
#include "server/calib/lidar_lidar/lidar_lidar_work.h"
#include "server/calib/motion/hand_eye_work.h"
#include "server/calib/tracker_lidar/tracker_lidar_work.h"

namespace rigcal::calib {

CapturesNeeded NeededBy(Method method) {
  switch (method) {
    case Method::kStereo: return {kCapturesMin, kCapturesEnough};
    case Method::kLidarCamera: return {kLidarCapturesMin, kLidarCapturesEnough};
    case Method::kLidarLidar: return {1, kCloudsEnough};
    case Method::kTrackerLidar: return {kTrackerLidarMin, kTrackerLidarEnough};
    case Method::kNonOverlapping:
    case Method::kTrackerCamera: return {kHandEyeMin, kHandEyeEnough};
    case Method::kPoseStreams: return {};
  }
  return {};
}

}  // namespace rigcal::calib
