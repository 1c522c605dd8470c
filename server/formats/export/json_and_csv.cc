// The product's own two forms. JSON: everything, as docs/api.md writes poses, covariances and cameras. CSV: a row per
// sensor for spreadsheets. In both T_root_sensor is the pose of the sensor in the root, p_root = T_root_sensor *
// p_sensor, and sigmas are along and about the sensor's own axes.
#include <cmath>

#include "server/formats/edges/camera_fit.h"
#include "server/formats/export/formats.h"
#include "server/formats/json/json_values.h"

namespace rigcal::exports {
namespace {

using formats::JsonWriter;

void WriteSensor(JsonWriter& out, const ExportedSensor& sensor) {
  out.Text("id", sensor.sensor.str());
  out.Text("frame", sensor.frame);
  sensor.kind ? out.Text("kind", NameOf(*sensor.kind)) : out.Null("kind");
  formats::WritePose(out, "T_root_sensor", sensor.T_root_sensor);
  formats::WriteMatrix(out, "covariance", sensor.covariance);
  formats::WriteSigmas(out, sensor.covariance);
  if (!sensor.camera) return out.Null("camera");
  out.Object("camera", [&] { formats::WriteCameraFitMembers(out, *sensor.camera); });
}

void WriteSentences(JsonWriter& out, const char* key, const std::vector<std::string>& sentences) {
  out.List(key, [&] {
    for (const std::string& sentence : sentences) out.Text(sentence);
  });
}

std::string CameraCells(const std::optional<CameraFit>& fit) {
  if (!fit) return ",,,,,,,";
  const CameraIntrinsics& values = fit->intrinsics;
  return NameOf(values.model) + "," + std::to_string(fit->width_px) + "," + std::to_string(fit->height_px) + "," +
         NumbersText({values.fx_px, values.fy_px, values.cx_px, values.cy_px}, ",") + "," +
         NumbersText(values.distortion, " ");
}

std::string RowText(const ExportedSensor& sensor) {
  const Se3& T = sensor.T_root_sensor;
  std::vector<double> numbers = {T.p_m.x(), T.p_m.y(), T.p_m.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w()};
  for (int axis = 0; axis < 6; ++axis) numbers.push_back(std::sqrt(sensor.covariance(axis, axis)));
  return sensor.frame + "," + (sensor.kind ? NameOf(*sensor.kind) : "") + "," + NumbersText(numbers, ",") + "," +
         CameraCells(sensor.camera) + "\n";
}

}  // namespace

Result<Written> WriteCalibrationJson(const Calibration& calibration) {
  const std::vector<std::string> convention = {
      "T_root_sensor is the pose of the sensor in the root: p_root = T_root_sensor * p_sensor; metres, Hamilton "
      "quaternion x y z w",
      "covariance: order x y z rx ry rz (m, rad), right perturbation T_root_sensor * Exp(xi): axes of the sensor",
      "the centre of the first pixel is 0, 0"};
  const std::string text = formats::WriteObject([&](JsonWriter& out) {
    out.Integer("format", 1);
    out.Text("robot", calibration.robot.str());
    out.Integer("revision", calibration.revision);
    out.Text("standing", calibration.standing);
    formats::WriteStamp(out, "calibrated_at", calibration.calibrated_at);
    out.Text("root", calibration.root_frame());
    WriteSentences(out, "convention", convention);
    WriteSentences(out, "left_out", calibration.left_out);
    out.List("sensors", [&] {
      for (const ExportedSensor& sensor : calibration.sensors) out.Object([&] { WriteSensor(out, sensor); });
    });
  });
  return Written{{{"", text + "\n"}}, {}};
}

Result<Written> WriteCalibrationCsv(const Calibration& calibration) {
  const std::vector<std::string> convention = {
      "Pose of each frame in the root: p_root = T * p_frame; metres, quaternion x y z w",
      "sigma: one standard deviation along and about the frame's own axes; distortion as docs/export.md orders it"};
  std::string text =
      Commented(HeadLines(calibration, convention), "# ") +
      "frame,kind,x_m,y_m,z_m,qx,qy,qz,qw,sigma_x_m,sigma_y_m,sigma_z_m,sigma_rx_rad,sigma_ry_rad,sigma_rz_rad,"
      "camera_model,width_px,height_px,fx_px,fy_px,cx_px,cy_px,distortion\n";
  for (const ExportedSensor& sensor : calibration.sensors) text += RowText(sensor);
  return Written{{{"", text}}, {}};
}

}  // namespace rigcal::exports
