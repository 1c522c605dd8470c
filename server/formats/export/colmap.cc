// COLMAP: cameras.txt (CAMERA_ID MODEL WIDTH HEIGHT PARAMS) and rig_config.json of its rig configurator, with pictures
// in a folder per camera, named as its frame. cam_from_rig maps points of the reference camera into the camera,
// quaternion w x y z. COLMAP counts pixels from the corner of the first one, we from its centre: cx and cy are larger
// by half a pixel.
#include "server/formats/export/formats.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::exports {
namespace {

constexpr double kPixelCentre_px = 0.5;

struct ColmapLens {
  std::string model;
  std::vector<double> parameters;
};

// FULL_OPENCV is OpenCV's rational model: with k4 to k6 zero its plain one.
ColmapLens LensOf(const CameraIntrinsics& values) {
  const bool fisheye = values.model == CameraModel::kFisheyeKb4;
  ColmapLens lens{fisheye ? "OPENCV_FISHEYE" : "FULL_OPENCV",
                  {values.fx_px, values.fy_px, values.cx_px + kPixelCentre_px, values.cy_px + kPixelCentre_px}};
  lens.parameters.insert(lens.parameters.end(), values.distortion.begin(), values.distortion.end());
  lens.parameters.resize(fisheye ? 8 : 12, 0.0);
  return lens;
}

void WriteNumberList(formats::JsonWriter& out, const char* key, const std::vector<double>& values) {
  out.List(key, [&] {
    for (const double value : values) out.Number(value);
  });
}

void WriteRigCamera(formats::JsonWriter& out, const ExportedSensor& camera, const ExportedSensor& reference) {
  const ColmapLens lens = LensOf(camera.camera->intrinsics);
  out.Text("image_prefix", camera.frame + "/");
  out.Text("camera_model_name", lens.model);
  WriteNumberList(out, "camera_params", lens.parameters);
  if (&camera == &reference) return out.Flag("ref_sensor", true);
  const Se3 T_cam_rig = (camera.T_root_sensor.Inverse() * reference.T_root_sensor).Normalized();
  WriteNumberList(out, "cam_from_rig_rotation", {T_cam_rig.q.w(), T_cam_rig.q.x(), T_cam_rig.q.y(), T_cam_rig.q.z()});
  WriteNumberList(out, "cam_from_rig_translation", {T_cam_rig.p_m.x(), T_cam_rig.p_m.y(), T_cam_rig.p_m.z()});
}

std::string RigText(const std::vector<const ExportedSensor*>& cameras) {
  formats::JsonWriter out;
  out.List([&] {
    out.Object([&] {
      out.List("cameras", [&] {
        for (const ExportedSensor* camera : cameras)
          out.Object([&] { WriteRigCamera(out, *camera, *cameras.front()); });
      });
    });
  });
  return out.Finish() + "\n";
}

std::string CameraLine(std::size_t id, const ExportedSensor& camera) {
  const ColmapLens lens = LensOf(camera.camera->intrinsics);
  return "# " + std::to_string(id) + " is " + camera.frame + "\n" + std::to_string(id) + " " + lens.model + " " +
         std::to_string(camera.camera->width_px) + " " + std::to_string(camera.camera->height_px) + " " +
         NumbersText(lens.parameters, " ") + "\n";
}

}  // namespace

Result<Written> WriteColmap(const Calibration& calibration) {
  Written written;
  RIGCAL_ASSIGN(auto cameras, CamerasToWrite(calibration, "COLMAP", written.left_out));
  RIGCAL_TRY(LeaveOutSpheres(cameras, "COLMAP", written.left_out));
  const std::vector<std::string> convention = {
      "CAMERA_ID MODEL WIDTH HEIGHT PARAMS: fx fy cx cy, then the distortion in OpenCV's order",
      "cx and cy count from the corner of the first pixel, as COLMAP does: half a pixel more than in OpenCV",
      "Poses are in rig_config.json: cam_from_rig maps points of the camera " + cameras.front()->frame +
          " into the camera, quaternion w x y z, metres"};
  std::string text = Commented(HeadLines(calibration, convention, written.left_out), "# ");
  for (std::size_t i = 0; i < cameras.size(); ++i) text += CameraLine(i + 1, *cameras[i]);
  written.files = {{"cameras.txt", text}, {"rig_config.json", RigText(cameras)}};
  return written;
}

}  // namespace rigcal::exports
