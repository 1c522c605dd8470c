// KITTI's calib.txt, a "name: numbers" per line. As in the odometry set P0, P1, ... project points of the first camera:
// the pixel of p_cam0 in camera i is P_i * [p_cam0; 1], with P_i = K_i [R_i | T_i], and Tr maps points of the lidar
// into the first camera (a second lidar: Tr_NAME). As in the raw set S_0i (size), K_0i, D_0i (k1 k2 p1 p2 k3), R_0i and
// T_0i (p_cam_i = R p_cam0 + T). KITTI's own P are of rectified pictures; these are of pictures of which only the
// distortion was taken out.
#include "server/formats/export/formats.h"

namespace rigcal::exports {
namespace {

std::string Line(const std::string& name, const std::vector<double>& values) {
  return name + ": " + NumbersText(values, " ") + "\n";
}

std::string CameraLines(std::size_t index, const ExportedSensor& camera, const Se3& T_cam_first) {
  const std::string number = (index < 10 ? "0" : "") + std::to_string(index);
  const Eigen::Matrix3d K = CameraMatrixOf(camera.camera->intrinsics);
  const Eigen::Matrix<double, 3, 4> P = K * T_cam_first.Matrix().topRows<3>();
  std::string text = "frame_" + number + ": " + camera.frame + "\n" + Line("P" + std::to_string(index), RowsOf(P));
  text += Line("S_" + number,
               {static_cast<double>(camera.camera->width_px), static_cast<double>(camera.camera->height_px)});
  text += Line("K_" + number, RowsOf(K)) + Line("D_" + number, camera.camera->intrinsics.distortion);
  return text + Line("R_" + number, RowsOf(T_cam_first.R())) + Line("T_" + number, RowsOf(T_cam_first.p_m));
}

// KITTI's D has five numbers: of other lenses it would be read wrong.
bool FitsKitti(const ExportedSensor& camera) { return camera.camera->intrinsics.model == CameraModel::kPinholeRadtan; }

std::string LidarLines(const Calibration& calibration, const Se3& T_first_root) {
  std::string text;
  for (const ExportedSensor& sensor : calibration.sensors) {
    if (sensor.kind != SensorKind::kLidar) continue;
    const Eigen::Matrix4d T_first_lidar = (T_first_root * sensor.T_root_sensor).Matrix();
    const std::string name = text.empty() ? "Tr" : "Tr_" + sensor.frame;
    if (text.empty()) text += "frame_Tr: " + sensor.frame + "\n";
    text += Line(name, RowsOf(T_first_lidar.topRows<3>()));
  }
  return text;
}

std::string HeadFields(const Calibration& calibration, const std::vector<std::string>& left_out) {
  const std::vector<std::string> convention = {
      "P_i project points of camera 0 into the undistorted picture of camera i: P_i = K_i [R_i | T_i]; p_cam_i = R_i "
      "p_cam0 + T_i",
      "Tr maps points of the lidar into camera 0; metres, pixels; matrices row by row; D is k1 k2 p1 p2 k3"};
  std::string text;
  std::size_t count = 0;
  for (const std::string& line : HeadLines(calibration, convention, left_out))
    text += "comment_" + std::to_string(count++) + ": " + line + "\n";
  return text;
}

}  // namespace

Result<Written> WriteKitti(const Calibration& calibration) {
  Written written;
  RIGCAL_ASSIGN(auto cameras, CamerasToWrite(calibration, "", written.left_out));
  std::erase_if(cameras, [&](const ExportedSensor* camera) {
    if (FitsKitti(*camera)) return false;
    written.left_out.push_back(camera->sensor.str() + ": KITTI's files hold k1 k2 p1 p2 k3 only, and its lens is " +
                               NameOf(camera->camera->intrinsics.model));
    return true;
  });
  if (cameras.empty()) return Fail(NoCameraError(calibration));
  for (const ExportedSensor& sensor : calibration.sensors)
    if (!sensor.is_camera() && sensor.kind != SensorKind::kLidar)
      written.left_out.push_back(sensor.sensor.str() + ": KITTI's files hold cameras and lidars");
  const Se3 T_first_root = cameras.front()->T_root_sensor.Inverse();
  std::string text = HeadFields(calibration, written.left_out);
  for (std::size_t i = 0; i < cameras.size(); ++i)
    text += CameraLines(i, *cameras[i], i == 0 ? Se3() : (T_first_root * cameras[i]->T_root_sensor).Inverse());
  written.files = {{"", text + LidarLines(calibration, T_first_root)}};
  return written;
}

}  // namespace rigcal::exports
