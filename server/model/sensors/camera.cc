#include "server/model/sensors/camera.h"

#include "server/base/text.h"
#include "server/model/named.h"

namespace rigcal {

std::string NameOf(CameraModel model) {
  switch (model) {
    case CameraModel::kPinholeRadtan:
      return "pinhole_radtan";
    case CameraModel::kPinholeRational:
      return "pinhole_rational";
    case CameraModel::kFisheyeKb4:
      return "fisheye_kb4";
  }
  return "pinhole_radtan";
}

Result<CameraModel> CameraModelOf(const std::string& name) {
  return ValueNamed(name, {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4},
                    "camera model", "Use pinhole_radtan, pinhole_rational or fisheye_kb4.");
}

std::size_t DistortionCount(CameraModel model) { return DistortionNames(model).size(); }

const std::vector<std::string>& DistortionNames(CameraModel model) {
  static const std::vector<std::string> kRadtan = {"k1", "k2", "p1", "p2", "k3"};
  static const std::vector<std::string> kRational = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  static const std::vector<std::string> kKb4 = {"k1", "k2", "k3", "k4"};
  if (model == CameraModel::kFisheyeKb4) return kKb4;
  return model == CameraModel::kPinholeRational ? kRational : kRadtan;
}

}  // namespace rigcal
