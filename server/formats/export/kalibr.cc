// Kalibr's camera chain: cam0, cam1, ... with intrinsics fx fy cx cy, distortion and T_cn_cnm1, which maps points of
// the camera before into this one: p_camN = T_cn_cnm1 * p_cam(N-1), the inverse direction of a pose in the chain's
// order. Its radtan has k1 k2 p1 p2 and no more; its equidistant is Kannala and Brandt's k1 to k4. Its eucm and ds are
// cameras without distortion whose intrinsics begin with alpha beta, and with xi alpha. A lens that is none of these is
// left out: another model's numbers would be wrong in the picture's corners.
#include "server/formats/export/formats.h"

namespace rigcal::exports {
namespace {

struct KalibrLens {
  std::string distortion;
  std::vector<double> coefficients;
  std::string camera = "pinhole";
  std::vector<double> before_focals = {};
};

Result<KalibrLens> LensOf(const CameraIntrinsics& intrinsics) {
  const std::vector<double>& d = intrinsics.distortion;
  if (intrinsics.model == CameraModel::kFisheyeKb4) return KalibrLens{"equidistant", d};
  if (intrinsics.model == CameraModel::kEucm) return KalibrLens{"none", {}, "eucm", d};
  if (intrinsics.model == CameraModel::kDoubleSphere) return KalibrLens{"none", {}, "ds", d};
  if (intrinsics.model == CameraModel::kPinholeRadtan && d[4] == 0.0)
    return KalibrLens{"radtan", {d[0], d[1], d[2], d[3]}};
  return Fail(ErrorCode::kUnsupported, "Kalibr's radtan has k1 k2 p1 p2 only, and this lens has more",
              "Take camera_info or opencv, or estimate the camera as fisheye_kb4.");
}

std::string MatrixText(const Se3& T) {
  std::string text;
  const Eigen::Matrix4d matrix = T.Matrix();
  for (Eigen::Index row = 0; row < 4; ++row) text += "    - [" + NumbersText(RowsOf(matrix.row(row)), ", ") + "]\n";
  return text;
}

std::string CameraText(std::size_t index, const ExportedSensor& camera, const KalibrLens& lens,
                       const ExportedSensor* before) {
  const CameraIntrinsics& values = camera.camera->intrinsics;
  std::vector<double> numbers = lens.before_focals;
  numbers.insert(numbers.end(), {values.fx_px, values.fy_px, values.cx_px, values.cy_px});
  std::string text =
      "cam" + std::to_string(index) + ":\n  rigcal_frame: " + InQuotes(camera.frame) + "\n  cam_overlaps: []\n";
  text += "  camera_model: " + lens.camera + "\n  intrinsics: [" + NumbersText(numbers, ", ") + "]\n";
  text += "  distortion_model: " + lens.distortion + "\n  distortion_coeffs: [" + NumbersText(lens.coefficients, ", ") +
          "]\n";
  text += "  resolution: [" + std::to_string(camera.camera->width_px) + ", " +
          std::to_string(camera.camera->height_px) + "]\n";
  text += "  rostopic: " + InQuotes("/" + camera.frame + "/image_raw") + "\n";
  if (before == nullptr) return text;
  const Se3 T_cn_cnm1 = camera.T_root_sensor.Inverse() * before->T_root_sensor;
  return text + "  T_cn_cnm1:\n" + MatrixText(T_cn_cnm1.Normalized());
}

}  // namespace

Result<Written> WriteKalibr(const Calibration& calibration) {
  Written written;
  RIGCAL_ASSIGN(const auto cameras, CamerasToWrite(calibration, "a camera chain", written.left_out));
  std::string chain;
  const ExportedSensor* before = nullptr;
  std::size_t index = 0;
  for (const ExportedSensor* camera : cameras) {
    const auto lens = LensOf(camera->camera->intrinsics);
    if (!lens) {
      written.left_out.push_back(camera->sensor.str() + ": " + lens.error().what);
      continue;
    }
    chain += CameraText(index++, *camera, *lens, before);
    before = camera;
  }
  if (before == nullptr) return Fail(LensOf(cameras.front()->camera->intrinsics).error());
  const std::vector<std::string> convention = {
      "p_camN = T_cn_cnm1 * p_cam(N-1): it maps points of the camera before into this one; metres",
      "intrinsics fx fy cx cy in pixels, of eucm after alpha beta, of ds after xi alpha; the centre of the first pixel "
      "is 0, 0",
      "rostopic is a guess from the name of the frame"};
  written.files = {{"", Commented(HeadLines(calibration, convention, written.left_out), "# ") + chain}};
  return written;
}

}  // namespace rigcal::exports
