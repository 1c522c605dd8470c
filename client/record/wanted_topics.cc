#include "client/record/wanted_topics.h"

#include <algorithm>

#include "client/bags/messages/definition.h"
#include "client/import/sensor_messages.h"

namespace rigcal::recording {
namespace {

using bags::MessageKind;
using Kinds = std::vector<MessageKind>;

void AddTopic(const std::string& name, const std::vector<std::string>& sensors, const Kinds& kinds,
              std::vector<WantedTopic>& wanted) {
  const auto known =
      std::find_if(wanted.begin(), wanted.end(), [&](const WantedTopic& one) { return one.name == name; });
  if (known == wanted.end()) return wanted.push_back({name, sensors, kinds});
  known->sensors.insert(known->sensors.end(), sensors.begin(), sensors.end());
  std::erase_if(known->kinds,
                [&](MessageKind kind) { return std::find(kinds.begin(), kinds.end(), kind) == kinds.end(); });
}

}  // namespace

std::vector<WantedTopic> WantedTopics(const importing::RigMap& map) {
  std::vector<WantedTopic> wanted;
  for (const importing::MappedSensor& sensor : map.sensors)
    AddTopic(sensor.topic, {sensor.id.str()}, importing::KindsFor(sensor), wanted);
  for (const importing::MappedSensor& sensor : map.sensors)
    if (!sensor.child_frame.empty())
      for (const std::string& name : importing::StaticTopicsFor(sensor.topic))
        AddTopic(name, {}, {MessageKind::kTransforms}, wanted);
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
               NameFor(topic) + " is published as " + type + ", and rig.yaml's sensor takes " +
                   importing::TypesText(topic.kinds),
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
