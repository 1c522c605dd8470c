#include "client/record/wanted_topics.h"

#include <algorithm>

#include "client/bags/messages/definition.h"

namespace rigcal::recording {
namespace {

using bags::MessageKind;
using Kinds = std::vector<MessageKind>;

constexpr const char* kStaticFrames = "/tf_static";

Kinds KindsFor(const importing::MappedSensor& sensor) {
  if (sensor.kind == SensorKind::kCamera) return {MessageKind::kImage, MessageKind::kCompressedImage};
  if (sensor.kind == SensorKind::kLidar) return {MessageKind::kCloud, MessageKind::kScan};
  if (!sensor.child_frame.empty()) return {MessageKind::kTransforms};
  return {MessageKind::kPose, MessageKind::kOdometry};
}

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

std::string TakenText(const Kinds& kinds) {
  std::string text;
  for (const MessageKind kind : kinds) text += (text.empty() ? "" : " or ") + NamesOf(kind);
  return text.empty() ? "nothing: its sensors have no type in common" : text;
}

}  // namespace

std::vector<WantedTopic> WantedTopics(const importing::RigMap& map) {
  std::vector<WantedTopic> wanted;
  bool any_frame = false;
  for (const importing::MappedSensor& sensor : map.sensors) {
    any_frame = any_frame || !sensor.child_frame.empty();
    const auto known =
        std::find_if(wanted.begin(), wanted.end(), [&](const WantedTopic& one) { return one.name == sensor.topic; });
    if (known == wanted.end()) {
      wanted.push_back({sensor.topic, {sensor.id.str()}, KindsFor(sensor)});
      continue;
    }
    known->sensors.push_back(sensor.id.str());
    const Kinds kinds = KindsFor(sensor);
    std::erase_if(known->kinds,
                  [&](MessageKind kind) { return std::find(kinds.begin(), kinds.end(), kind) == kinds.end(); });
  }
  const bool has_static =
      std::any_of(wanted.begin(), wanted.end(), [](const WantedTopic& one) { return one.name == kStaticFrames; });
  if (any_frame && !has_static) wanted.push_back({kStaticFrames, {}, {MessageKind::kTransforms}});
  return wanted;
}

std::optional<Error> WhyNot(const WantedTopic& topic, const std::string& type) {
  const bool fits = std::find(topic.kinds.begin(), topic.kinds.end(), bags::KindOf(type)) != topic.kinds.end();
  if (fits && !bags::KnownMsgText(bags::PlainTypeName(type), false).empty()) return std::nullopt;
  if (fits)
    return Error{ErrorCode::kUnsupported,
                 NameFor(topic) + " is published as " + type + ", whose layout is not known here",
                 "It is not recorded: publish a type of docs/bags.md."};
  return Error{ErrorCode::kInvalidInput,
               NameFor(topic) + " is published as " + type + ", and rig.yaml's sensor takes " + TakenText(topic.kinds),
               "It is not recorded: mend its `topic` or `type` in rig.yaml, or what publishes there."};
}

std::string NameFor(const WantedTopic& topic) {
  std::string text = topic.name;
  for (std::size_t i = 0; i < topic.sensors.size(); ++i) text += (i == 0 ? " (" : ", ") + topic.sensors[i];
  return topic.sensors.empty() ? text : text + ")";
}

bags::Topic BagTopicOf(const std::string& name, const std::string& type) {
  return {name, type, "cdr", "ros2msg", bags::KnownMsgText(bags::PlainTypeName(type), false)};
}

}  // namespace rigcal::recording
