// URDF: a link per sensor, a fixed joint from the root link to each other one. The origin of a joint is the pose of its
// child in its parent, xyz in metres, rpy in radians about fixed axes: R = Rz(yaw) Ry(pitch) Rx(roll). Numbers that
// both R and rpy of a reader come back from to rounding, also where pitch is +-90 degrees.
#include "server/formats/export/formats.h"
#include "server/math/roll_pitch_yaw.h"

namespace rigcal::exports {
namespace {

std::string Triple(const Eigen::Vector3d& v) { return NumbersText({v[0], v[1], v[2]}, " "); }

std::string JointText(const ExportedSensor& sensor, const std::string& root_frame) {
  const Eigen::Vector3d rpy_rad = RollPitchYawOf(sensor.T_root_sensor.R());
  const std::string frame = XmlText(sensor.frame);
  return "  <joint name=\"" + frame + "_joint\" type=\"fixed\">\n    <origin xyz=\"" +
         Triple(sensor.T_root_sensor.p_m) + "\" rpy=\"" + Triple(rpy_rad) + "\"/>\n    <parent link=\"" +
         XmlText(root_frame) + "\"/>\n    <child link=\"" + frame + "\"/>\n  </joint>\n";
}

}  // namespace

Result<Written> WriteUrdf(const Calibration& calibration) {
  const std::vector<std::string> convention = {
      "An origin is the pose of the child link in the parent link: p_parent = T_parent_child * p_child",
      "xyz in metres; rpy in radians about fixed axes, R = Rz(yaw) Ry(pitch) Rx(roll)",
      "Links of cameras are optical frames: z forward, x right, y down"};
  std::string text = "<?xml version=\"1.0\"?>\n" + XmlComment(HeadLines(calibration, convention));
  text += "<robot name=\"" + XmlText(calibration.robot.str()) + "\">\n";
  for (const ExportedSensor& sensor : calibration.sensors) text += "  <link name=\"" + XmlText(sensor.frame) + "\"/>\n";
  for (const ExportedSensor& sensor : calibration.sensors)
    if (sensor.sensor != calibration.root) text += JointText(sensor, calibration.root_frame());
  return Written{{{"", text + "</robot>\n"}}, {}};
}

}  // namespace rigcal::exports
