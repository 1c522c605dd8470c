#include "server/formats/export/formats.h"

#include <array>
#include <vector>

#include "server/formats/json/nearest.h"

namespace rigcal::exports {
namespace {

constexpr std::array kFormats = {
    Format{"urdf", ".urdf", WriteUrdf, "links and fixed joints; with --into the origins of an existing robot"},
    Format{"tf2", ".tf.yaml", WriteTf2, "tf2_msgs/TFMessage as YAML, for /tf_static"},
    Format{"tf2_launch", ".launch.xml", WriteTf2Launch, "ROS 2 launch file of static_transform_publisher"},
    Format{"kalibr", "", WriteKalibr, "Kalibr's camera chain with intrinsics"},
    Format{"camera_info", "", WriteCameraInfo, "a folder: ROS camera_info YAML, one per camera", true},
    Format{"opencv", "", WriteOpenCv, "OpenCV FileStorage YAML: K, distortion, 4x4 poses"},
    Format{"autoware", "", WriteAutoware, "Autoware's sensor_kit_calibration.yaml"},
    Format{"kitti", "", WriteKitti, "KITTI's calib.txt"},
    Format{"colmap", "", WriteColmap, "a folder: COLMAP's cameras.txt and rig_config.json", true},
    Format{"basalt", "", WriteBasalt, "Basalt's calibration JSON"},
    Format{"json", ".json", WriteCalibrationJson, "everything: poses, covariances, intrinsics"},
    Format{"csv", ".csv", WriteCalibrationCsv, "a row per sensor: pose, sigmas, intrinsics"},
};

bool EndsWith(std::string_view text, std::string_view end) {
  return text.size() > end.size() && text.substr(text.size() - end.size()) == end;
}

}  // namespace

std::span<const Format> Formats() { return kFormats; }

Result<const Format*> FormatCalled(std::string_view name) {
  std::vector<std::string_view> names;
  for (const Format& format : kFormats) {
    if (format.name == name) return &format;
    names.push_back(format.name);
  }
  return Fail(ErrorCode::kInvalidInput, "there is no format '" + std::string(name.substr(0, 32)) + "'",
              "Known are g2o, " + formats::Listed(names) + ".");
}

Result<const Format*> FormatOfFile(std::string_view file) {
  const Format* best = nullptr;
  for (const Format& format : kFormats)
    if (!format.suffix.empty() && EndsWith(file, format.suffix) &&
        (best == nullptr || format.suffix.size() > best->suffix.size()))
      best = &format;
  if (best != nullptr) return best;
  return Fail(ErrorCode::kInvalidInput, "the suffix of " + std::string(file) + " names no format",
              "Say which with --format; `rigcal export --help` lists them.");
}

}  // namespace rigcal::exports
