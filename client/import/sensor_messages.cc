#include "client/import/sensor_messages.h"

namespace rigcal::importing {
namespace {

using bags::MessageKind;

std::string NamesOf(MessageKind kind) {
  switch (kind) {
    case MessageKind::kImage:
      return "sensor_msgs/msg/Image";
    case MessageKind::kCompressedImage:
      return "sensor_msgs/msg/CompressedImage";
    case MessageKind::kCloud:
      return "sensor_msgs/msg/PointCloud2";
    case MessageKind::kScan:
      return "sensor_msgs/msg/LaserScan";
    case MessageKind::kPose:
      return "geometry_msgs/msg/PoseStamped, PoseWithCovarianceStamped, TransformStamped";
    case MessageKind::kOdometry:
      return "nav_msgs/msg/Odometry";
    case MessageKind::kTransforms:
      return "tf2_msgs/msg/TFMessage";
    default:
      return "none";
  }
}

}  // namespace

std::vector<MessageKind> KindsFor(const MappedSensor& sensor) {
  if (sensor.kind == SensorKind::kCamera) return {MessageKind::kImage, MessageKind::kCompressedImage};
  if (sensor.kind == SensorKind::kLidar) return {MessageKind::kCloud, MessageKind::kScan};
  if (sensor.child_frame.empty()) return {MessageKind::kPose, MessageKind::kOdometry};
  return {MessageKind::kTransforms, MessageKind::kPose, MessageKind::kOdometry};
}

std::string TypesText(const std::vector<MessageKind>& kinds) {
  std::string text;
  for (const MessageKind kind : kinds) text += (text.empty() ? "" : " or ") + NamesOf(kind);
  return text.empty() ? "nothing: its sensors have no type in common" : text;
}

std::vector<std::string> StaticTopicsFor(const std::string& topic) {
  const std::string rooted = topic.rfind('/', 0) == 0 ? topic : "/" + topic;
  std::vector<std::string> names;
  for (std::size_t end = rooted.rfind('/');; end = rooted.rfind('/', end - 1)) {
    names.push_back(rooted.substr(0, end) + "/tf_static");
    if (end == 0) return names;
  }
}

}  // namespace rigcal::importing
