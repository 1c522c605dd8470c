// Camera models and their intrinsics. Pixel (0,0) is the centre of the first pixel.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal {

// "pinhole_radtan": k1 k2 p1 p2 k3. "pinhole_rational": k1 k2 p1 p2 k3 k4 k5 k6 (both OpenCV's order and formula).
// "fisheye_kb4": k1 k2 k3 k4 of Kannala & Brandt (2006), theta_d = theta (1 + k1 theta^2 + ... + k4 theta^8).
// "eucm": alpha beta of Khomutenko, Garcia & Martinet (2016); "double_sphere": xi alpha of Usenko, Demmel & Cremers
// (2018). Both u = fx x / (alpha d2 + (1 - alpha) k) + cx: eucm with k = z, d2 = |(sqrt(beta) x, sqrt(beta) y, z)|,
// double_sphere with k = xi |p| + z, d2 = |(x, y, k)|. On the axis the latter's focal length is fx / (1 + xi).
enum class CameraModel { kPinholeRadtan, kPinholeRational, kFisheyeKb4, kEucm, kDoubleSphere };
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(CameraModel model);
[[nodiscard]] Result<CameraModel> CameraModelOf(const std::string& name);
// Sees less than 180 degrees, and has the tangential distortions p1 and p2.
[[nodiscard]] constexpr bool IsPinhole(CameraModel model) {
  return model == CameraModel::kPinholeRadtan || model == CameraModel::kPinholeRational;
}
// eucm and double_sphere: their distortion is no series, and without it there is no lens.
[[nodiscard]] constexpr bool IsSphere(CameraModel model) {
  return model == CameraModel::kEucm || model == CameraModel::kDoubleSphere;
}
// 5, 8, 4, 2, 2.
[[nodiscard]] std::size_t DistortionCount(CameraModel model);
// Distortion names in order: "k1", "k2", "p1", ...
[[nodiscard]] const std::vector<std::string>& DistortionNames(CameraModel model);

struct CameraIntrinsics {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::vector<double> distortion = std::vector<double>(5, 0.0);  // DistortionCount(model) values
  CameraModel model = CameraModel::kPinholeRadtan;
  friend bool operator==(const CameraIntrinsics&, const CameraIntrinsics&) = default;
};
// Empty, or which number no lens of a sphere model has ("alpha 1.2 is not within 0 to 1"): alpha within 0 to 1, beta
// above 0, xi above -1 and below 1. `intrinsics` has DistortionCount(model) values; those of other models may be any.
[[nodiscard]] std::string WhyNoSphere(const CameraIntrinsics& intrinsics);
// Pixels per radian on the axis, along x.
[[nodiscard]] double AxialFocal_px(const CameraIntrinsics& intrinsics);

}  // namespace rigcal
