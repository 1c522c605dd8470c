#include "server/formats/export/file_text.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace rigcal::exports {
namespace {

std::string RevisionLine(const Calibration& calibration) {
  std::string line = "Rigcal: robot " + calibration.robot.str() + ", revision " + std::to_string(calibration.revision) +
                     " (" + calibration.standing + ")";
  return calibration.calibrated_at ? line + ", measured as of " + ToIso(*calibration.calibrated_at) : line;
}

}  // namespace

std::string NumberText(double value) {
  if (value == 0.0) return "0.0";  // -0.0, too
  std::array<char, 32> digits{};
  const auto [end, status] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  std::string text(digits.data(), status == std::errc() ? end : digits.data());
  if (text.find('.') == std::string::npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string NumbersText(const std::vector<double>& values, std::string_view between) {
  std::string text;
  for (const double value : values) text.append(text.empty() ? "" : between).append(NumberText(value));
  return text;
}

std::vector<double> RowsOf(const Eigen::MatrixXd& matrix) {
  std::vector<double> values;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) values.push_back(matrix(row, column));
  return values;
}

std::string InQuotes(std::string_view name) { return "\"" + std::string(name) + "\""; }

std::vector<std::string> HeadLines(const Calibration& calibration, const std::vector<std::string>& convention,
                                   const std::vector<std::string>& left_out) {
  std::vector<std::string> lines = {RevisionLine(calibration), "Root frame: " + calibration.root_frame()};
  lines.insert(lines.end(), convention.begin(), convention.end());
  for (const auto* sentences : {&calibration.left_out, &left_out})
    for (const std::string& sentence : *sentences) lines.push_back("Left out: " + sentence);
  return lines;
}

std::string Commented(const std::vector<std::string>& lines, std::string_view before) {
  std::string text;
  for (const std::string& line : lines) text.append(before).append(line).append("\n");
  return text;
}

std::string XmlComment(const std::vector<std::string>& lines) {
  std::string inside = Commented(lines, "  ");
  for (std::size_t at = inside.find("--"); at != std::string::npos; at = inside.find("--", at))
    inside.insert(at + 1, " ");
  return "<!--\n" + inside + "-->\n";
}

std::string XmlText(std::string_view text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

Error NoCameraError(const Calibration& calibration) {
  return {ErrorCode::kNotFound, "no camera of " + calibration.robot.str() + " has intrinsics that this format can hold",
          "Push a session with pictures of a board, or take a format of poses: urdf, tf2, json or csv."};
}

Result<std::vector<const ExportedSensor*>> CamerasToWrite(const Calibration& calibration,
                                                          const std::string& cameras_only,
                                                          std::vector<std::string>& left_out) {
  std::vector<const ExportedSensor*> cameras;
  for (const ExportedSensor& sensor : calibration.sensors) {
    if (sensor.camera)
      cameras.push_back(&sensor);
    else if (sensor.is_camera())
      left_out.push_back(sensor.sensor.str() + ": a camera of which no intrinsics are known");
    else if (!cameras_only.empty())
      left_out.push_back(sensor.sensor.str() + ": " + cameras_only + " has cameras only");
  }
  if (cameras.empty()) return Fail(NoCameraError(calibration));
  return cameras;
}

Status LeaveOutSpheres(std::vector<const ExportedSensor*>& cameras, const std::string& format,
                       std::vector<std::string>& left_out) {
  const auto told = [&](const ExportedSensor& camera) {
    return camera.sensor.str() + ": " + NameOf(camera.camera->intrinsics.model) + " is a lens that " + format +
           " does not have";
  };
  std::string last;
  std::erase_if(cameras, [&](const ExportedSensor* camera) {
    if (!IsSphere(camera->camera->intrinsics.model)) return false;
    left_out.push_back(last = told(*camera));
    return true;
  });
  if (!cameras.empty()) return {};
  return Fail(ErrorCode::kUnsupported, last, "Take kalibr, basalt or json, or estimate the camera as fisheye_kb4.");
}

Eigen::Matrix3d CameraMatrixOf(const CameraIntrinsics& intrinsics) {
  Eigen::Matrix3d K;
  K << intrinsics.fx_px, 0, intrinsics.cx_px, 0, intrinsics.fy_px, intrinsics.cy_px, 0, 0, 1;
  return K;
}

}  // namespace rigcal::exports
