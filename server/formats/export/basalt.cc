// Basalt's calibration JSON: T_imu_cam is the pose of each camera in the IMU, whose place the root takes: p_root =
// T_imu_cam * p_cam. Fisheyes are its kb4, sphere models its eucm and ds, all others its pinhole-radtan8 (OpenCV's
// rational model); rpmax 0 sets no limit to the radius. Noise and biases of an IMU and the vignette are not calibrated
// by Rigcal and are not made up. What Basalt does not read comes last, in an object of its own: it takes the first
// member of the file for the calibration.
#include "server/formats/export/formats.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::exports {
namespace {

using formats::JsonWriter;

void WriteCameraPose(JsonWriter& out, const Se3& T) {
  const std::pair<const char*, double> members[] = {{"px", T.p_m.x()}, {"py", T.p_m.y()}, {"pz", T.p_m.z()},
                                                    {"qx", T.q.x()},   {"qy", T.q.y()},   {"qz", T.q.z()},
                                                    {"qw", T.q.w()}};
  for (const auto& [key, value] : members) out.Number(key, value);
}

const char* CameraTypeOf(CameraModel model) {
  if (model == CameraModel::kEucm) return "eucm";
  if (model == CameraModel::kDoubleSphere) return "ds";
  return IsPinhole(model) ? "pinhole-radtan8" : "kb4";
}

void WriteLens(JsonWriter& out, const CameraIntrinsics& values) {
  out.Text("camera_type", CameraTypeOf(values.model));
  out.Object("intrinsics", [&] {
    out.Number("fx", values.fx_px);
    out.Number("fy", values.fy_px);
    out.Number("cx", values.cx_px);
    out.Number("cy", values.cy_px);
    const std::vector<std::string>& names =
        DistortionNames(IsPinhole(values.model) ? CameraModel::kPinholeRational : values.model);
    for (std::size_t k = 0; k < names.size(); ++k)
      out.Number(names[k], k < values.distortion.size() ? values.distortion[k] : 0.0);
    if (IsPinhole(values.model)) out.Number("rpmax", 0.0);
  });
}

void WriteCameras(JsonWriter& out, const std::vector<const ExportedSensor*>& cameras) {
  out.List("T_imu_cam", [&] {
    for (const ExportedSensor* camera : cameras) out.Object([&] { WriteCameraPose(out, camera->T_root_sensor); });
  });
  out.List("intrinsics", [&] {
    for (const ExportedSensor* camera : cameras) out.Object([&] { WriteLens(out, camera->camera->intrinsics); });
  });
  out.List("resolution", [&] {
    for (const ExportedSensor* camera : cameras)
      out.List([&] {
        out.Integer(camera->camera->width_px);
        out.Integer(camera->camera->height_px);
      });
  });
}

void WriteOrigin(JsonWriter& out, const Calibration& calibration, const std::vector<const ExportedSensor*>& cameras,
                 const std::vector<std::string>& left_out) {
  const std::vector<std::string> convention = {
      "T_imu_cam: p_root = T_imu_cam * p_cam, metres, quaternion; the root stands where Basalt has the IMU",
      "noise and biases of an IMU and vignette are not told: take them from the IMU's own calibration"};
  out.List("convention", [&] {
    for (const std::string& line : HeadLines(calibration, convention, left_out)) out.Text(line);
  });
  out.List("frames", [&] {
    for (const ExportedSensor* camera : cameras) out.Text(camera->frame);
  });
}

}  // namespace

Result<Written> WriteBasalt(const Calibration& calibration) {
  Written written;
  RIGCAL_ASSIGN(const auto cameras, CamerasToWrite(calibration, "Basalt's file", written.left_out));
  std::erase_if(written.left_out,
                [&](const std::string& one) { return one.rfind(calibration.root.str() + ": Basalt", 0) == 0; });
  const std::string text = formats::WriteObject([&](JsonWriter& out) {
    out.Object("value0", [&] { WriteCameras(out, cameras); });
    out.Object("written_by_rigcal", [&] { WriteOrigin(out, calibration, cameras, written.left_out); });
  });
  written.files = {{"", text + "\n"}};
  return written;
}

}  // namespace rigcal::exports
