// Camera models and their intrinsics. Pixel (0,0) is the centre of the first pixel.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal {

// "pinhole_radtan": k1 k2 p1 p2 k3. "pinhole_rational": k1 k2 p1 p2 k3 k4 k5 k6 (both OpenCV's order and formula).
// "fisheye_kb4": k1 k2 k3 k4 of Kannala & Brandt (2006), theta_d = theta (1 + k1 theta^2 + ... + k4 theta^8).
enum class CameraModel { kPinholeRadtan, kPinholeRational, kFisheyeKb4 };
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(CameraModel model);
[[nodiscard]] Result<CameraModel> CameraModelOf(const std::string& name);
// 5, 8, 4.
[[nodiscard]] std::size_t DistortionCount(CameraModel model);
// Distortion names in order: "k1", "k2", "p1", ...
[[nodiscard]] const std::vector<std::string>& DistortionNames(CameraModel model);

struct CameraIntrinsics {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::vector<double> distortion = std::vector<double>(5, 0.0);  // DistortionCount(model) values
  CameraModel model = CameraModel::kPinholeRadtan;
  friend bool operator==(const CameraIntrinsics&, const CameraIntrinsics&) = default;
};

}  // namespace rigcal
