// Autoware's sensor_kit_calibration.yaml: under the root frame, of each other frame x y z (m) and roll pitch yaw (rad,
// fixed axes, R = Rz(yaw) Ry(pitch) Rx(roll)), its pose in the root. Autoware's `NAME/camera_link` looks along +x, z
// up, with the optical frame turned inside it: that is what is written of a camera NAME.
#include "server/formats/export/formats.h"
#include "server/formats/rig_axes.h"
#include "server/math/roll_pitch_yaw.h"

namespace rigcal::exports {
namespace {

std::string FrameText(const std::string& frame, const Se3& T) {
  const Eigen::Vector3d rpy_rad = RollPitchYawOf(T.R());
  std::string text = "  " + InQuotes(frame) + ":\n";
  const char* const kKeys[] = {"x", "y", "z", "roll", "pitch", "yaw"};
  for (int k = 0; k < 6; ++k)
    text += std::string("    ") + kKeys[k] + ": " + NumberText(k < 3 ? T.p_m[k] : rpy_rad[k - 3]) + "\n";
  return text;
}

// Of a camera's frame, also where that was named after its body already.
std::string LinkNameOf(const std::string& frame) {
  return frame.ends_with(kCameraLinkSuffix) ? frame : frame + std::string(kCameraLinkSuffix);
}

}  // namespace

Result<Written> WriteAutoware(const Calibration& calibration) {
  const std::vector<std::string> convention = {
      "Pose of each frame in " + calibration.root_frame() + ": p_root = T * p_frame; x y z in metres",
      "roll pitch yaw in radians about fixed axes, R = Rz(yaw) Ry(pitch) Rx(roll)",
      "NAME/camera_link is the body of camera NAME: x forward, y left, z up; its optical frame is turned by roll -90, "
      "yaw -90 degrees",
      "Other frames, the root too, are the sensors' own"};
  std::string text = Commented(HeadLines(calibration, convention), "# ") + InQuotes(calibration.root_frame()) + ":\n";
  for (const ExportedSensor& sensor : calibration.sensors) {
    if (sensor.sensor == calibration.root) continue;
    if (sensor.is_camera())
      text += FrameText(LinkNameOf(sensor.frame), sensor.T_root_sensor * LinkOfOptical().Inverse());
    else
      text += FrameText(sensor.frame, sensor.T_root_sensor);
  }
  return Written{{{"", text}}, {}};
}

}  // namespace rigcal::exports
