// Static transforms of ROS 2: as the YAML of one tf2_msgs/TFMessage (what `ros2 topic pub /tf_static
// tf2_msgs/msg/TFMessage` takes), and as a launch file of static_transform_publisher (ROS 2 Humble or newer: named
// arguments). In both a transform is the pose of child_frame_id in frame_id: p_parent = T_parent_child * p_child;
// metres, quaternion x y z w.
#include <set>

#include "server/formats/export/formats.h"

namespace rigcal::exports {
namespace {

const std::vector<std::string>& Convention() {
  static const std::vector<std::string> convention = {
      "A transform is the pose of the child frame in the parent: p_parent = T_parent_child * p_child",
      "Metres; quaternion x y z w", "Frames of cameras are optical frames: z forward, x right, y down"};
  return convention;
}

std::string TransformText(const ExportedSensor& sensor, const std::string& root_frame) {
  const Eigen::Vector3d& p_m = sensor.T_root_sensor.p_m;
  const Eigen::Quaterniond& q = sensor.T_root_sensor.q;
  return "  - header:\n      stamp: {sec: 0, nanosec: 0}\n      frame_id: " + InQuotes(root_frame) +
         "\n    child_frame_id: " + InQuotes(sensor.frame) +
         "\n    transform:\n      translation: {x: " + NumberText(p_m.x()) + ", y: " + NumberText(p_m.y()) +
         ", z: " + NumberText(p_m.z()) + "}\n      rotation: {x: " + NumberText(q.x()) + ", y: " + NumberText(q.y()) +
         ", z: " + NumberText(q.z()) + ", w: " + NumberText(q.w()) + "}\n";
}

// Names of nodes are words: letters, digits and underscores. `taken` has those of the nodes before: a-b and a_b are
// two.
std::string NodeName(const std::string& frame, std::set<std::string>& taken) {
  std::string name = "static_transform_" + frame;
  for (char& c : name)
    if (c == '-' || c == '.' || c == '/') c = '_';
  std::string free = name;
  for (int k = 2; !taken.insert(free).second; ++k) free = name + "__" + std::to_string(k);
  return free;
}

std::string NodeText(const ExportedSensor& sensor, const std::string& root_frame, const std::string& name) {
  const Eigen::Vector3d& p_m = sensor.T_root_sensor.p_m;
  const Eigen::Quaterniond& q = sensor.T_root_sensor.q;
  return "  <node pkg=\"tf2_ros\" exec=\"static_transform_publisher\" name=\"" + name + "\"\n        args=\"--x " +
         NumberText(p_m.x()) + " --y " + NumberText(p_m.y()) + " --z " + NumberText(p_m.z()) + " --qx " +
         NumberText(q.x()) + " --qy " + NumberText(q.y()) + " --qz " + NumberText(q.z()) + " --qw " +
         NumberText(q.w()) + " --frame-id " + XmlText(root_frame) + " --child-frame-id " + XmlText(sensor.frame) +
         "\"/>\n";
}

}  // namespace

Result<Written> WriteTf2(const Calibration& calibration) {
  std::string text = Commented(HeadLines(calibration, Convention()), "# ") + "transforms:\n";
  for (const ExportedSensor& sensor : calibration.sensors)
    if (sensor.sensor != calibration.root) text += TransformText(sensor, calibration.root_frame());
  return Written{{{"", text}}, {}};
}

Result<Written> WriteTf2Launch(const Calibration& calibration) {
  std::string text = XmlComment(HeadLines(calibration, Convention())) + "<launch>\n";
  std::set<std::string> names;
  for (const ExportedSensor& sensor : calibration.sensors)
    if (sensor.sensor != calibration.root)
      text += NodeText(sensor, calibration.root_frame(), NodeName(sensor.frame, names));
  return Written{{{"", text + "</launch>\n"}}, {}};
}

}  // namespace rigcal::exports
