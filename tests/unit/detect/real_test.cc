#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "server/detect/board.h"
#include "tests/unit/recordings.h"

namespace rigcal::detect {
namespace {

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
  RIGCAL_SKIP_WITHOUT_STEREO_PAIRS();
  int found = 0;
  for (const auto& [name, path] : StereoPairs()) {
    const AnnotatedView result = DetectFile(path, {TargetId("board"), 9, 6, 0.025, 0, ""});
    EXPECT_TRUE(result.view.found) << path << ": " << result.view.why_not;
    if (!result.view.found) continue;
    ++found;
    ExpectRightHanded(result.view, 9);
  }
  EXPECT_EQ(found, 26);
}

TEST(DetectReal, EveryPictureOfTheRobotArm) {
  RIGCAL_SKIP_WITHOUT_RECORDING("handeye_visp_franka");
  const auto folder = Recording("handeye_visp_franka/data-eye-in-hand");
  for (int i = 1; i <= 8; ++i) {
    const auto path = folder / ("franka_image-" + std::to_string(i) + ".png");
    const AnnotatedView result = DetectFile(path, {TargetId("board"), 9, 6, 0.0236, 0, ""});
    ASSERT_TRUE(result.view.found) << path << ": " << result.view.why_not;
    ExpectRightHanded(result.view, 9);
  }
}

}  // namespace
}  // namespace rigcal::detect
