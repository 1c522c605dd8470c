// Which topics a rig map asks for, and what each may be.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/bags/messages/header.h"
#include "client/import/rig_map.h"

namespace rigcal::recording {

struct WantedTopic {
  std::string name;                      // "/left/image_raw"
  std::vector<std::string> sensors;      // ids of rig.yaml; none: frames that other transforms need
  std::vector<bags::MessageKind> kinds;  // that all of these sensors take
  // It need not be there, nor go on: transforms that stand still.
  [[nodiscard]] bool IsOptional() const { return sensors.empty(); }
};

// In the map's order, each topic once; behind them those of
// static transforms (StaticTopicsFor) where a sensor is a frame.
[[nodiscard]] std::vector<WantedTopic> WantedTopics(const importing::RigMap& map);
// Nothing: messages of this type ("sensor_msgs/msg/Image") can be recorded for the topic's sensors. Else why not,
// kInvalidInput.
[[nodiscard]] std::optional<Error> WhyNot(const WantedTopic& topic, const std::string& type);
// "/left (left)", "/tf (flange, tool)": as people are told.
[[nodiscard]] std::string NameFor(const WantedTopic& topic);
// The topic as a bag has it, with the definition that this program knows of the type.
[[nodiscard]] bags::Topic BagTopicOf(const std::string& name, const std::string& type);

}  // namespace rigcal::recording
