// Real pictures of a ChArUco board held by a person, against what another program found in them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <opencv2/calib3d.hpp>
#include <sstream>

#include "server/detect/board.h"
#include "server/formats/sessions/session_folder.h"
#include "tests/unit/recordings.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::detect {
namespace {

namespace fs = std::filesystem;
constexpr const char* kRecording = "multicam_caliscope/4_cam_recording";

std::string BytesOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

using Corners = std::map<int, Eigen::Vector2d>;
using Views = std::map<std::pair<int, int>, Corners>;  // camera, capture

// xy.csv: sync_index,cam_id,frame_index,frame_time,object_id,keypoint_id,img_loc_x,img_loc_y,...
Views OtherProgram() {
  Views views;
  std::ifstream file(Recording(kRecording) / "calibration/extrinsic/xy.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double> fields;
    std::istringstream text(line);
    for (std::string field; std::getline(text, field, ',');) fields.push_back(field.empty() ? NAN : std::stod(field));
    views[{static_cast<int>(fields[1]), static_cast<int>(fields[0])}][static_cast<int>(fields[5])] = {fields[6],
                                                                                                      fields[7]};
  }
  return views;
}

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

// How flat the board is in the given intrinsics: rms from a homography of the undistorted corners.
double FlatnessRms_px(const Sensor& camera, const Corners& corners, int cols) {
  const CameraIntrinsics& k = *camera.intrinsics;
  const cv::Matx33d K(k.fx_px, 0, k.cx_px, 0, k.fy_px, k.cy_px, 0, 0, 1);
  std::vector<cv::Point2d> board, pixels, straight, fitted;
  for (const auto& [idx, pixel] : corners) {
    board.emplace_back(idx % cols, idx / cols);
    pixels.emplace_back(pixel.x(), pixel.y());
  }
  cv::undistortPoints(pixels, straight, K, k.distortion, cv::noArray(), K);
  cv::perspectiveTransform(board, fitted, cv::findHomography(board, straight));
  double sum = 0;
  for (std::size_t i = 0; i < fitted.size(); ++i) sum += (fitted[i] - straight[i]).dot(fitted[i] - straight[i]);
  return std::sqrt(sum / static_cast<double>(fitted.size()));
}

Corners Found(const fs::path& path, const Target& target) {
  const std::string bytes = BytesOf(path);
  const BoardView view = Detect(std::as_bytes(std::span(bytes)), target).view;
  Corners corners;
  for (std::size_t i = 0; i < view.corner_idx.size(); ++i) corners[view.corner_idx[i]] = view.corners_px[i];
  return corners;
}

// Distances of common corners. The other program counts the columns of pictures seen from behind from one.
std::vector<double> Distances_px(const Corners& ours, const Corners& theirs, bool from_behind) {
  std::vector<double> distances_px;
  for (const auto& [idx, pixel] : theirs)
    if (const auto found = ours.find(idx); found != ours.end())
      distances_px.push_back((found->second - pixel + Eigen::Vector2d(from_behind ? 1 : 0, 0)).norm());
  return distances_px;
}

struct CameraResult {
  int pictures = 0, found = 0, found_by_other = 0, corners = 0, corners_of_other = 0;
  std::vector<double> distances_px, flatness_px;
};

CameraResult Compare(const fs::path& folder, int number, const Target& target, const Sensor& camera,
                     const Views& theirs) {
  CameraResult result;
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder)) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) {
    const Corners ours = Found(path, target);
    const auto other = theirs.find({number, std::stoi(path.stem().string())});
    ++result.pictures;
    result.found += ours.empty() ? 0 : 1;
    result.corners += static_cast<int>(ours.size());
    if (ours.size() >= 8) result.flatness_px.push_back(FlatnessRms_px(camera, ours, target.cols));
    if (other == theirs.end()) continue;
    result.found_by_other += other->second.size() >= 6 ? 1 : 0;
    result.corners_of_other += static_cast<int>(other->second.size());
    const std::vector<double> distances_px = Distances_px(ours, other->second, number == 1);
    result.distances_px.insert(result.distances_px.end(), distances_px.begin(), distances_px.end());
  }
  return result;
}

// The session folder of the recording, for as long as a test runs.
class DetectCaliscope : public testing::Test {
 protected:
  void SetUp() override {
    RIGCAL_SKIP_WITHOUT_RECORDING(kRecording);
    if (std::system("ffmpeg -version >/dev/null 2>&1") != 0)
      GTEST_SKIP() << "no ffmpeg to take the pictures out of the videos; deploy/install brings it";
    const std::string extract = RIGCAL_PYTHON " " RIGCAL_SOURCE_DIR "/tests/data/extract_caliscope.py ";
    const std::string command = extract + Recording(kRecording).string() + " " + session_.string();
    ASSERT_EQ(std::system(command.c_str()), 0) << command;
  }
  TempFolder place_;
  const fs::path session_ = place_.path();
};

TEST_F(DetectCaliscope, FindsWhatAnotherProgramFound) {
  const auto header = formats::ReadSessionYaml(BytesOf(session_ / "session.yaml"), "session.yaml");
  ASSERT_TRUE(header) << header.error().what;
  ASSERT_EQ(header->sensors.size(), 4u);
  const Views theirs = OtherProgram();
  for (int number = 0; number < 4; ++number) {
    SCOPED_TRACE(number);
    const Sensor& camera = header->sensors[static_cast<std::size_t>(number)];
    const CameraResult result = Compare(session_ / camera.id.str(), number, header->targets.front(), camera, theirs);
    std::cout << camera.id.str() << ": " << result.found << " of " << result.pictures << " pictures (the other program "
              << result.found_by_other << "), " << result.corners << " corners (" << result.corners_of_other
              << "), median distance " << Median(result.distances_px) << " px, flat to " << Median(result.flatness_px)
              << " px\n";
    EXPECT_GE(result.pictures, 20);
    EXPECT_GE(result.found, result.found_by_other - 1);
    EXPECT_GE(result.corners, 0.95 * result.corners_of_other);
    EXPECT_LT(Median(result.distances_px), 0.7);
    EXPECT_LT(Median(result.flatness_px), 0.25);
  }
}

}  // namespace
}  // namespace rigcal::detect
