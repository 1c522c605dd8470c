// Which messages a sensor of rig.yaml takes: by their types, and which topics of static transforms belong to it.
#pragma once

#include <string>
#include <vector>

#include "client/bags/messages/header.h"
#include "client/import/rig_map.h"

namespace rigcal::importing {

// In the order in which people are told of them.
[[nodiscard]] std::vector<bags::MessageKind> KindsFor(const MappedSensor& sensor);
// "sensor_msgs/msg/Image or sensor_msgs/msg/CompressedImage"; of none "nothing: its sensors have no type in common".
[[nodiscard]] std::string TypesText(const std::vector<bags::MessageKind>& kinds);

// Of transforms on this topic, the topics with what stands still between its frames: that of its own namespace and of
// each around it. "/r1/arm/tf": "/r1/arm/tf_static", "/r1/tf_static", "/tf_static"; "/r2/tf_static" is another robot's.
[[nodiscard]] std::vector<std::string> StaticTopicsFor(const std::string& topic);

}  // namespace rigcal::importing
