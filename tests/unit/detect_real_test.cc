#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/detect/board.h"

namespace rigcal::detect {
namespace {

const std::filesystem::path kData = RIGCAL_SOURCE_DIR "/../shared/data";

AnnotatedView DetectFile(const std::filesystem::path& path, const Target& board) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  return Detect(std::as_bytes(std::span(bytes)), board);
}

void ExpectRightHanded(const BoardView& view, std::size_t cols) {
  const auto& corners = view.corners_px;
  const Eigen::Vector2d along = corners[1] - corners[0], down = corners[cols] - corners[0];
  EXPECT_GT(along.x() * down.y() - along.y() * down.x(), 0);
}

TEST(DetectReal, EveryPictureOfTheStereoPairs) {
  const auto folder = kData / "stereo_opencv";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the real stereo pairs are not here: " << folder;
  int found = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".jpg") continue;
    const AnnotatedView result = DetectFile(entry.path(), {TargetId("board"), 9, 6, 0.025, 0, ""});
    EXPECT_TRUE(result.view.found) << entry.path() << ": " << result.view.why_not;
    if (!result.view.found) continue;
    ++found;
    ExpectRightHanded(result.view, 9);
  }
  EXPECT_EQ(found, 26);
}

TEST(DetectReal, EveryPictureOfTheRobotArm) {
  const auto folder = kData / "handeye_visp_franka/data-eye-in-hand";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the robot arm's pictures are not here: " << folder;
  for (int i = 1; i <= 8; ++i) {
    const auto path = folder / ("franka_image-" + std::to_string(i) + ".png");
    const AnnotatedView result = DetectFile(path, {TargetId("board"), 9, 6, 0.0236, 0, ""});
    ASSERT_TRUE(result.view.found) << path << ": " << result.view.why_not;
    ExpectRightHanded(result.view, 9);
  }
}

}  // namespace
}  // namespace rigcal::detect
