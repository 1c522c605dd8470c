// A calibration as messages of ROS 2: the same poses and lenses as in the files of formats `tf2` and `camera_info`.
#pragma once

#include <map>
#include <string>

#include "idl/convert.h"
#include "idl/ros/topics.h"
#include "server/base/result.h"
#include "server/base/stamp.h"
#include "server/formats/export/calibration.h"

namespace rigcal::client {

// Of each sensor but the root its pose in the root, as T_parent_child: metres, quaternion x y z w, in the calibration's
// order. All in one message: of a topic that keeps the newest only, late joiners get that one.
[[nodiscard]] wire::Owned<wire::RosTransforms> TransformsOf(const exports::Calibration& calibration, Stamp stamp = {});

// `camera` has intrinsics and a size.
[[nodiscard]] wire::Owned<wire::RosCameraInfo> CameraInfoOf(const exports::ExportedSensor& camera, Stamp stamp = {});

// Topics by camera: rt/NAME/camera_info, NAME as ROS 2 allows it: letters, digits and single underscores, no digit
// first. kInvalidInput where two cameras would have the same.
[[nodiscard]] Result<std::map<std::string, const exports::ExportedSensor*>> CameraTopics(
    const std::vector<const exports::ExportedSensor*>& cameras);

}  // namespace rigcal::client
