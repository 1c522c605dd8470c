#include "server/formats/export/ros_camera.h"

#include "server/formats/export/file_text.h"

namespace rigcal::exports {
namespace {

const char* DistortionModelOf(CameraModel model) {
  if (model == CameraModel::kFisheyeKb4) return "equidistant";
  return model == CameraModel::kPinholeRational ? "rational_polynomial" : "plumb_bob";
}

}  // namespace

RosCamera RosCameraOf(const CameraFit& camera) {
  RosCamera ros;
  ros.width_px = camera.width_px, ros.height_px = camera.height_px;
  ros.distortion_model = DistortionModelOf(camera.intrinsics.model);
  ros.D = camera.intrinsics.distortion;
  ros.K = CameraMatrixOf(camera.intrinsics);
  ros.R = Eigen::Matrix3d::Identity();
  ros.P.setZero();
  ros.P.leftCols<3>() = ros.K;
  return ros;
}

}  // namespace rigcal::exports
