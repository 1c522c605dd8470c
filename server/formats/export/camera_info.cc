// ROS camera_info YAML, one file per camera (camera_calibration_parsers): K of the picture as it is, D in OpenCV's order, R the
// identity and P = [K | 0], as of a camera that is not rectified. The extrinsics have no place in it: its comment has the pose.
#include "server/formats/export/formats.h"

namespace rigcal::exports {
namespace {

const char* DistortionModelOf(CameraModel model) {
  if (model == CameraModel::kFisheyeKb4) return "equidistant";
  return model == CameraModel::kPinholeRational ? "rational_polynomial" : "plumb_bob";
}

std::string MatrixText(const char* name, int rows, const std::vector<double>& values) {
  const int cols = static_cast<int>(values.size()) / rows;
  return std::string(name) + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(cols) + "\n  data: [" +
         NumbersText(values, ", ") + "]\n";
}

// "/" would make folders of it.
std::string FileName(const std::string& frame) {
  std::string name = frame;
  for (char& c : name)
    if (c == '/') c = '_';
  return name + ".yaml";
}

std::string CameraInfoText(const Calibration& calibration, const ExportedSensor& camera, const std::vector<std::string>& left_out) {
  const CameraIntrinsics& values = camera.camera->intrinsics;
  const Eigen::Matrix3d K = CameraMatrixOf(values);
  Eigen::Matrix<double, 3, 4> P = Eigen::Matrix<double, 3, 4>::Zero();
  P.leftCols<3>() = K;
  const Se3& T = camera.T_root_sensor;
  const std::vector<std::string> convention = {
      "Not rectified: R is the identity, P = [K | 0]; the centre of the first pixel is 0, 0",
      "Pose of this camera in " + calibration.root_frame() + ", p_root = T * p_camera: x y z (m) " +
          NumbersText({T.p_m.x(), T.p_m.y(), T.p_m.z()}, " ") + ", quaternion x y z w " +
          NumbersText({T.q.x(), T.q.y(), T.q.z(), T.q.w()}, " ")};
  std::string text = Commented(HeadLines(calibration, convention, left_out), "# ");
  text += "image_width: " + std::to_string(camera.camera->width_px) + "\nimage_height: " + std::to_string(camera.camera->height_px) +
          "\ncamera_name: " + InQuotes(camera.frame) + "\n";
  text += MatrixText("camera_matrix", 3, RowsOf(K));
  text += std::string("distortion_model: ") + DistortionModelOf(values.model) + "\n";
  text += MatrixText("distortion_coefficients", 1, values.distortion);
  text += MatrixText("rectification_matrix", 3, RowsOf(Eigen::Matrix3d::Identity()));
  return text + MatrixText("projection_matrix", 3, RowsOf(P));
}

}  // namespace

Result<Written> WriteCameraInfo(const Calibration& calibration) {
  Written written;
  RIGCAL_ASSIGN(const auto cameras, CamerasToWrite(calibration, "camera_info", written.left_out));
  for (const ExportedSensor* camera : cameras) {
    const std::string name = FileName(camera->frame);
    for (const TextFile& other : written.files)
      if (other.name == name)
        return Fail(ErrorCode::kInvalidInput, "two cameras would have the file " + name, "Give them other names with --frame.");
    written.files.push_back({name, CameraInfoText(calibration, *camera, written.left_out)});
  }
  return written;
}

}  // namespace rigcal::exports
