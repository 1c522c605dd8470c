// Topics of ROS 2 as Rigcal writes them: names with ROS 2's "rt/" before, types of ros2.idl, no partition, no keys.
// Reliable, kept for late joiners, the newest only: what tf2_ros's static broadcaster offers, and so what its listeners
// ask for.
#pragma once

#include "idl/dds.h"
#include "ros2.h"

namespace rigcal::wire {

using RosTransforms = tf2_msgs_msg_dds__TFMessage_;
using RosCameraInfo = sensor_msgs_msg_dds__CameraInfo_;

inline constexpr const char* kRosTopics = "rt/";  // before the name of every topic
template <>
[[nodiscard]] const TopicInfo& InfoOf<RosTransforms>();  // rt/tf_static
// Each camera has a topic of its own: Writer::OpenCalled gives it its name.
template <>
[[nodiscard]] const TopicInfo& InfoOf<RosCameraInfo>();

}  // namespace rigcal::wire
