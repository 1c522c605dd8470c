#include "server/model/sensors/camera.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "server/base/text.h"
#include "server/model/named.h"

namespace rigcal {
namespace {

std::string SevenDigits(double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.7g", value);
  return text.data();
}

}  // namespace

std::string NameOf(CameraModel model) {
  switch (model) {
    case CameraModel::kPinholeRadtan:
      return "pinhole_radtan";
    case CameraModel::kPinholeRational:
      return "pinhole_rational";
    case CameraModel::kFisheyeKb4:
      return "fisheye_kb4";
    case CameraModel::kEucm:
      return "eucm";
    case CameraModel::kDoubleSphere:
      return "double_sphere";
  }
  return "pinhole_radtan";
}

Result<CameraModel> CameraModelOf(const std::string& name) {
  return ValueNamed(name,
                    {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4,
                     CameraModel::kEucm, CameraModel::kDoubleSphere},
                    "camera model", "Use pinhole_radtan, pinhole_rational, fisheye_kb4, eucm or double_sphere.");
}

std::size_t DistortionCount(CameraModel model) { return DistortionNames(model).size(); }

const std::vector<std::string>& DistortionNames(CameraModel model) {
  static const std::vector<std::string> kRadtan = {"k1", "k2", "p1", "p2", "k3"};
  static const std::vector<std::string> kRational = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  static const std::vector<std::string> kKb4 = {"k1", "k2", "k3", "k4"};
  static const std::vector<std::string> kEucm = {"alpha", "beta"};
  static const std::vector<std::string> kDoubleSphere = {"xi", "alpha"};
  switch (model) {
    case CameraModel::kPinholeRational:
      return kRational;
    case CameraModel::kFisheyeKb4:
      return kKb4;
    case CameraModel::kEucm:
      return kEucm;
    case CameraModel::kDoubleSphere:
      return kDoubleSphere;
    case CameraModel::kPinholeRadtan:
      break;
  }
  return kRadtan;
}

std::string WhyNoSphere(const CameraIntrinsics& intrinsics) {
  if (!IsSphere(intrinsics.model)) return "";
  const std::vector<std::string>& names = DistortionNames(intrinsics.model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double value = intrinsics.distortion[i];
    const std::string told = names[i] + " " + SevenDigits(value);
    if (names[i] == "alpha" && !(value >= 0 && value <= 1)) return told + " is not within 0 to 1";
    if (names[i] == "beta" && !(value > 0)) return told + " is not above 0";
    if (names[i] == "xi" && !(std::abs(value) < 1)) return told + " is not between -1 and 1";
  }
  return "";
}

double AxialFocal_px(const CameraIntrinsics& intrinsics) {
  return intrinsics.model == CameraModel::kDoubleSphere ? intrinsics.fx_px / (1 + intrinsics.distortion.front())
                                                        : intrinsics.fx_px;
}

}  // namespace rigcal
