// A real fisheye: 20 pictures of a 7 x 5 board (95 mm), intrinsics of its authors.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>

#include "server/calib/camera/intrinsics.h"
#include "server/detect/checkerboard/corners.h"
#include "tests/unit/recordings.h"

namespace rigcal::calib {
namespace {

constexpr const char* kPictures = "lidarcam_acfr_vlp16/images";

Target Board() { return {TargetId("board"), 7, 5, 0.095, 0.0, ""}; }

CameraIntrinsics Given() {
  return {
      1176.93, 1177.72, 962.275, 612.725, {-0.0540096, -0.0784275, 0.0959641, -0.0515253}, CameraModel::kFisheyeKb4};
}

BoardView ViewIn(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  BoardView view{false, "no board", TargetId("board"), 0, 0, {}};
  const auto image = detect::DecodeGrey(std::as_bytes(std::span(bytes)));
  if (!image) return view;
  view.image_width_px = image->width_px;
  view.image_height_px = image->height_px;
  const auto corners = detect::FindCorners(*image, 7, 5);
  if (!corners) return view;
  view.found = true;
  view.corners_px = *corners;
  view.corner_idx.resize(corners->size());
  std::iota(view.corner_idx.begin(), view.corner_idx.end(), 0);
  return view;
}

CameraProblem AllPictures() {
  CameraProblem problem;
  problem.camera.id = SensorId("camera");
  problem.camera.camera_model = CameraModel::kFisheyeKb4;
  problem.board = Board();
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(Recording(kPictures)))
    if (entry.path().extension() == ".png") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  for (const auto& path : paths) problem.views.emplace_back(CaptureId(path.stem().string()), ViewIn(path));
  return problem;
}

class RealFisheye : public testing::Test {
 protected:
  void SetUp() override {
    RIGCAL_SKIP_WITHOUT_RECORDING(kPictures);
    static const CameraProblem problem = AllPictures();
    problem_ = problem;
  }
  CameraProblem problem_;
};

TEST_F(RealFisheye, GivenIntrinsicsExplainEveryPicture) {
  problem_.camera.intrinsics = Given();
  const auto estimate = EstimateCamera(problem_);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->T_cam_board.size(), 20U);
  EXPECT_LT(estimate->rms_px, 0.25);
  for (const auto& [capture, T_cam_board] : estimate->T_cam_board) {
    EXPECT_GT(T_cam_board.p_m.norm(), 1) << capture.str();
    EXPECT_LT(T_cam_board.p_m.norm(), 8) << capture.str();
    EXPECT_LT(estimate->rms_by_capture_px.at(capture), 1.0) << capture.str();
  }
}

TEST_F(RealFisheye, EstimatedIntrinsicsAreNearTheGiven) {
  const auto estimate = EstimateCamera(problem_);
  ASSERT_TRUE(estimate) << estimate.error().what;
  const CameraIntrinsics& found = estimate->intrinsics;
  EXPECT_NEAR(found.fx_px, Given().fx_px, 0.03 * Given().fx_px);
  EXPECT_NEAR(found.cx_px, Given().cx_px, 30);
  EXPECT_LT(estimate->rms_px, 0.25);
}

// Eight views of the twenty: from no idea of the lens to its authors' focal length.
TEST_F(RealFisheye, EightPicturesAreEnough) {
  CameraProblem eight = problem_;
  eight.views.clear();
  for (std::size_t i = 0; i < 8; ++i) eight.views.push_back(problem_.views[i * problem_.views.size() / 8]);
  const auto estimate = EstimateCamera(eight);
  ASSERT_TRUE(estimate) << estimate.error().what;
  EXPECT_EQ(estimate->T_cam_board.size(), 8U);
  EXPECT_NEAR(estimate->intrinsics.fx_px, Given().fx_px, 0.05 * Given().fx_px);
  EXPECT_LT(estimate->rms_px, 0.25);
}

}  // namespace
}  // namespace rigcal::calib
