#include "idl/ros/topics.h"

namespace rigcal::wire {
namespace {

constexpr bool kForLateJoiners = true;
constexpr int kOnlyNewest = 1;
constexpr int kReaderSamplesMax = 100;  // as many as tf2_ros's listener holds

}  // namespace

template <>
const TopicInfo& InfoOf<RosTransforms>() {
  static const TopicInfo info{"rt/tf_static", &tf2_msgs_msg_dds__TFMessage__desc, kForLateJoiners, kOnlyNewest,
                              kReaderSamplesMax};
  return info;
}

template <>
const TopicInfo& InfoOf<RosCameraInfo>() {
  static const TopicInfo info{"rt/camera_info", &sensor_msgs_msg_dds__CameraInfo__desc, kForLateJoiners, kOnlyNewest,
                              kReaderSamplesMax};
  return info;
}

}  // namespace rigcal::wire
