// cv::FileStorage YAML: a sequence `sensors`, each with its frame and T_root_sensor as a 4x4 matrix (p_root =
// T_root_sensor * p_sensor), of cameras also K, the distortion in OpenCV's order and its size. A sequence, because
// names of nodes may not begin with a digit. OpenCV has no sphere models: of such cameras the pose alone is written.
#include "server/formats/export/formats.h"

namespace rigcal::exports {
namespace {

// The numbers in lines that FileStorage takes, whatever the matrix.
std::string MatrixText(const std::string& name, Eigen::Index rows, Eigen::Index cols,
                       const std::vector<double>& values) {
  return "     " + name + ": !!opencv-matrix\n        rows: " + std::to_string(rows) +
         "\n        cols: " + std::to_string(cols) + "\n        dt: d\n        data: [ " +
         NumbersText(values, ",\n            ") + " ]\n";
}

std::string CameraText(const CameraFit& fit) {
  const std::vector<double>& d = fit.intrinsics.distortion;
  return "     model: " + InQuotes(NameOf(fit.intrinsics.model)) +
         "\n     image_width: " + std::to_string(fit.width_px) +
         "\n     image_height: " + std::to_string(fit.height_px) + "\n" +
         MatrixText("camera_matrix", 3, 3, RowsOf(CameraMatrixOf(fit.intrinsics))) +
         MatrixText("distortion_coefficients", 1, static_cast<Eigen::Index>(d.size()), d);
}

bool HasLens(const ExportedSensor& sensor) { return sensor.camera && !IsSphere(sensor.camera->intrinsics.model); }

std::string WhyNoLens(const ExportedSensor& sensor) {
  return sensor.camera ? NameOf(sensor.camera->intrinsics.model) + " is a lens that OpenCV does not have"
                       : "none are known";
}

std::string SensorText(const ExportedSensor& sensor) {
  std::string text = "   -\n     frame: " + InQuotes(sensor.frame) + "\n" +
                     MatrixText("T_root_sensor", 4, 4, RowsOf(sensor.T_root_sensor.Matrix()));
  return HasLens(sensor) ? text + CameraText(*sensor.camera) : text;
}

}  // namespace

Result<Written> WriteOpenCv(const Calibration& calibration) {
  Written written;
  for (const ExportedSensor& sensor : calibration.sensors)
    if (sensor.is_camera() && !HasLens(sensor))
      written.left_out.push_back("intrinsics of " + sensor.sensor.str() + ": " + WhyNoLens(sensor));
  const std::vector<std::string> convention = {
      "T_root_sensor: p_root = T_root_sensor * p_sensor, 4x4, metres; the inverse of what cv::projectPoints takes of "
      "root points",
      "model pinhole_radtan: k1 k2 p1 p2 k3; pinhole_rational: k1 k2 p1 p2 k3 k4 k5 k6; fisheye_kb4: k1 k2 k3 k4 of "
      "cv::fisheye"};
  std::string text = "%YAML:1.0\n---\n" + Commented(HeadLines(calibration, convention, written.left_out), "# ");
  text += "root: " + InQuotes(calibration.root_frame()) + "\nsensors:\n";
  for (const ExportedSensor& sensor : calibration.sensors) text += SensorText(sensor);
  written.files = {{"", text}};
  return written;
}

}  // namespace rigcal::exports
