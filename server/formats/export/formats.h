// The formats in which a calibration leaves, one row each. A new one: its writer in a file of its own, declared here, a
// row in formats.cc, a row in docs/export.md and a test with a reader that is not ours.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "server/formats/export/file_text.h"

namespace rigcal::exports {

// Pure: the same calibration, the same bytes. Conventions are in each writer's file, in its comments and in
// docs/export.md. kNotFound where nothing is left to write.
using Writer = Result<Written> (*)(const Calibration& calibration);

struct Format {
  std::string_view name;    // as --format takes it
  std::string_view suffix;  // of its file, by which it is chosen without --format; empty: it is not
  Writer write;
  std::string_view what;   // one line for --help
  bool is_folder = false;  // several files: what was asked for is a folder
};

// All, in the order of --help.
[[nodiscard]] std::span<const Format> Formats();
// kInvalidInput with what was probably meant.
[[nodiscard]] Result<const Format*> FormatCalled(std::string_view name);
// By how the file's name ends, the longest suffix first; kInvalidInput where that tells no format.
[[nodiscard]] Result<const Format*> FormatOfFile(std::string_view file);

[[nodiscard]] Result<Written> WriteUrdf(const Calibration& calibration);  // a fresh robot of links and fixed joints
[[nodiscard]] Result<Written> WriteTf2(const Calibration& calibration);   // tf2_msgs/TFMessage as YAML
[[nodiscard]] Result<Written> WriteTf2Launch(
    const Calibration& calibration);  // static_transform_publisher, ROS 2 launch XML
[[nodiscard]] Result<Written> WriteKalibr(const Calibration& calibration);      // camchain.yaml
[[nodiscard]] Result<Written> WriteCameraInfo(const Calibration& calibration);  // one YAML per camera
[[nodiscard]] Result<Written> WriteOpenCv(const Calibration& calibration);      // cv::FileStorage YAML
[[nodiscard]] Result<Written> WriteAutoware(const Calibration& calibration);    // sensor_kit_calibration.yaml
[[nodiscard]] Result<Written> WriteKitti(const Calibration& calibration);       // calib.txt
[[nodiscard]] Result<Written> WriteColmap(const Calibration& calibration);      // cameras.txt and rig_config.json
[[nodiscard]] Result<Written> WriteBasalt(const Calibration& calibration);      // calibration JSON
// JSON: as docs/api.md writes poses, with whole covariances. CSV: a row per sensor, sigmas only.
[[nodiscard]] Result<Written> WriteCalibrationJson(const Calibration& calibration);
[[nodiscard]] Result<Written> WriteCalibrationCsv(const Calibration& calibration);

}  // namespace rigcal::exports
