// ROS camera_info YAML, one file per camera (camera_calibration_parsers): K of the picture as it is, D in OpenCV's
// order, R the identity and P = [K | 0], as of a camera that is not rectified. The extrinsics have no place in it: its
// comment has the pose.
#include "server/formats/export/formats.h"
#include "server/formats/export/ros_camera.h"

namespace rigcal::exports {
namespace {

std::string MatrixText(const char* name, int rows, const std::vector<double>& values) {
  const int cols = static_cast<int>(values.size()) / rows;
  return std::string(name) + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(cols) +
         "\n  data: [" + NumbersText(values, ", ") + "]\n";
}

// "/" would make folders of it.
std::string FileName(const std::string& frame) {
  std::string name = frame;
  for (char& c : name)
    if (c == '/') c = '_';
  return name + ".yaml";
}

std::string CameraInfoText(const Calibration& calibration, const ExportedSensor& camera,
                           const std::vector<std::string>& left_out) {
  const RosCamera ros = RosCameraOf(*camera.camera);
  const Se3& T = camera.T_root_sensor;
  const std::vector<std::string> convention = {
      "Not rectified: R is the identity, P = [K | 0]; the centre of the first pixel is 0, 0",
      "Pose of this camera in " + calibration.root_frame() + ", p_root = T * p_camera: x y z (m) " +
          NumbersText({T.p_m.x(), T.p_m.y(), T.p_m.z()}, " ") + ", quaternion x y z w " +
          NumbersText({T.q.x(), T.q.y(), T.q.z(), T.q.w()}, " ")};
  std::string text = Commented(HeadLines(calibration, convention, left_out), "# ");
  text += "image_width: " + std::to_string(ros.width_px) + "\nimage_height: " + std::to_string(ros.height_px) +
          "\ncamera_name: " + InQuotes(camera.frame) + "\n";
  text += MatrixText("camera_matrix", 3, RowsOf(ros.K));
  text += "distortion_model: " + ros.distortion_model + "\n";
  text += MatrixText("distortion_coefficients", 1, ros.D);
  text += MatrixText("rectification_matrix", 3, RowsOf(ros.R));
  return text + MatrixText("projection_matrix", 3, RowsOf(ros.P));
}

}  // namespace

Result<Written> WriteCameraInfo(const Calibration& calibration) {
  Written written;
  RIGCAL_ASSIGN(auto cameras, CamerasToWrite(calibration, "camera_info", written.left_out));
  RIGCAL_TRY(LeaveOutSpheres(cameras, "camera_info", written.left_out));
  for (const ExportedSensor* camera : cameras) {
    const std::string name = FileName(camera->frame);
    for (const TextFile& other : written.files)
      if (other.name == name)
        return Fail(ErrorCode::kInvalidInput, "two cameras would have the file " + name,
                    "Give them other names with --frame.");
    written.files.push_back({name, CameraInfoText(calibration, *camera, written.left_out)});
  }
  return written;
}

}  // namespace rigcal::exports
