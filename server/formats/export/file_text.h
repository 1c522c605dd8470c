// What the writers share: numbers, names and comments as the formats hold them, and which cameras go in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/formats/export/calibration.h"

namespace rigcal::exports {

// A file of an export. `name`: empty, the file that was asked for; else its place in the folder that was asked for.
struct TextFile {
  std::string name, text;
};
struct Written {
  std::vector<TextFile> files;
  std::vector<std::string>
      left_out;  // what this format leaves out beside what the calibration does; likewise in its comments
};

// The shortest digits that read back as the same double, always with a point: YAML 1.1 takes 1e-05 for a word. `value`
// is finite.
[[nodiscard]] std::string NumberText(double value);
// Numbers with `between` in between.
[[nodiscard]] std::string NumbersText(const std::vector<double>& values, std::string_view between);
// Row by row: a whole 4x4 matrix, or the upper 3x4 of it.
[[nodiscard]] std::vector<double> RowsOf(const Eigen::MatrixXd& matrix);
[[nodiscard]] std::string InQuotes(std::string_view name);  // "name", for YAML and OpenCV; names have no quotes in them

// Robot, revision and its standing, root; `convention`, line by line; what is left out. Without comment signs.
[[nodiscard]] std::vector<std::string> HeadLines(const Calibration& calibration,
                                                 const std::vector<std::string>& convention,
                                                 const std::vector<std::string>& left_out = {});
[[nodiscard]] std::string Commented(const std::vector<std::string>& lines,
                                    std::string_view before);  // "# " before each
// <!-- ... -->, with no "--" inside.
[[nodiscard]] std::string XmlComment(const std::vector<std::string>& lines);
[[nodiscard]] std::string XmlText(std::string_view text);  // & < > " escaped

// Those with intrinsics, in the calibration's order; cameras without are named in `left_out`, all other sensors too
// where `cameras_only` names the format that has room for none. kNotFound where no camera remains.
[[nodiscard]] Result<std::vector<const ExportedSensor*>> CamerasToWrite(const Calibration& calibration,
                                                                        const std::string& cameras_only,
                                                                        std::vector<std::string>& left_out);
[[nodiscard]] Error NoCameraError(const Calibration& calibration);
// Leaves away those whose lens the format has no name for, and names them in `left_out`: "eucm is a lens that `format`
// does not have". kUnsupported where none remains.
[[nodiscard]] Status LeaveOutSpheres(std::vector<const ExportedSensor*>& cameras, const std::string& format,
                                     std::vector<std::string>& left_out);
// fx 0 cx; 0 fy cy; 0 0 1, pixels.
[[nodiscard]] Eigen::Matrix3d CameraMatrixOf(const CameraIntrinsics& intrinsics);

}  // namespace rigcal::exports
