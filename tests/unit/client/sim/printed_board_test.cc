// Pictures of boards that are not checkerboards, and of plates off their pattern, against the product's own search,
// which knows nothing of how they are drawn.
#include <gmock/gmock.h>

#include <cmath>

#include "client/sim/rig/printed_pattern.h"
#include "client/sim/rig/random.h"
#include "client/sim/views/picture.h"
#include "client/sim/visit/observe.h"
#include "server/detect/board.h"
#include "tests/unit/client/sim/sample.h"

namespace rigcal::sim {
namespace {

using testing::HasSubstr;

struct Found {
  int boards = 0, missed = 0, points = 0;
  double squares_px2 = 0;
  [[nodiscard]] double Rms_px() const { return std::sqrt(squares_px2 / std::max(1, 2 * points)); }  // of one coordinate
};

std::string RigYaml(const std::string& board) {
  return R"(format: 1
name: one-board
robot: one-board
reference: front
nominal_sigma_m: 0.01
nominal_sigma_deg: 1
motion: {captures: 6, start_m: [0, 0, 2], position_range_m: [0.2, 0.3, 0.2], yaw_range_deg: 10, tilt_rms_deg: 8}
boards:
  board: {)" +
         board + R"(, T_world_plate: {p_m: [0, 0, 2], rpy_deg: [4, 3, -8]}}
room: {size_m: [6, 6, 4], patches_per_wall: 8}
camera: {size_px: [1200, 900], blur_px: 0.7, noise_grey: 2, vignetting_ratio: 0.3, corner_sigma_px: 0.03}
sensors:
  front: {type: camera, sees: board, T_body_sensor: {p_m: [-1.3, 0.1, 0.05], rpy_deg: [0, 3, -3]}, lens: {fx_px: 1100, fy_px: 1101, cx_px: 600, cy_px: 450, distortion: [-0.1, 0.02, 0, 0, 0]}, intrinsics_sigma: [0.3, 0.3, 0.3, 0.3, 0, 0, 0, 0, 0]}
)";
}

Experiment ExperimentOf(const std::string& board) {
  const auto rig = ReadRig(RigYaml(board), "rig.yaml");
  EXPECT_TRUE(rig) << Sentence(rig.error());
  return Prepared(rig.value());
}

Found FindAll(const Experiment& experiment, const Target& target) {
  const Scene scene = SceneOf(experiment.rig);
  const RigSensor& camera = experiment.rig.sensors.front();
  Found found;
  for (std::size_t k = 0; k < experiment.captures.size(); ++k) {
    const auto truth = TrueCorners(experiment, scene, camera, k);
    if (!truth) continue;
    const Picture picture = TakePicture(scene, camera.camera, RayGrid(camera.camera, Eigen::Vector2d::Zero()),
                                        experiment.T_world_sensor(camera.id, k), KeyOf(7, "test", camera.id.str(), k));
    const auto bytes = Encoded(picture, PictureFormat::kPng).value();
    const auto view = detect::Detect(std::as_bytes(std::span(bytes)), target).view;
    ++found.boards;
    if (!view.found) ++found.missed;
    for (std::size_t i = 0; i < view.corners_px.size(); ++i, ++found.points)
      found.squares_px2 += (view.corners_px[i] - (*truth)[static_cast<std::size_t>(view.corner_idx[i])]).squaredNorm();
  }
  return found;
}

void ExpectFound(const std::string& board, int points_min) {
  SCOPED_TRACE(board);
  const Experiment experiment = ExperimentOf(board);
  const Found found = FindAll(experiment, experiment.rig.boards.front().target);
  EXPECT_GE(found.boards, 5);
  EXPECT_EQ(found.missed, 0);
  EXPECT_GE(found.points, found.boards * points_min);
  EXPECT_LT(found.Rms_px(), 0.1);
}

TEST(SimPrintedBoards, PointsAreWhereGeometryPutsThem) {
  const std::string plate = ", plate_size_m: [0.8, 0.6]";
  ExpectFound(
      "type: charuco, squares: [7, 5], square_size_m: 0.09, marker_size_m: 0.065, dictionary: DICT_5X5_100" + plate,
      20);
  ExpectFound("type: april_grid, tags: [4, 3], tag_size_m: 0.12, spacing_ratio: 0.3" + plate, 40);
  ExpectFound("type: aruco_grid, tags: [4, 3], tag_size_m: 0.12, spacing_ratio: 0.3, dictionary: DICT_6X6_250" + plate,
              40);
  ExpectFound("type: circle_grid, circles: [7, 5], spacing_m: 0.09, diameter_m: 0.05" + plate, 35);
  ExpectFound("type: asymmetric_circle_grid, circles: [4, 7], spacing_m: 0.07, diameter_m: 0.06" + plate, 28);
}

TEST(SimPrintedBoards, MarkersMayHaveAnyIds) {
  ExpectFound(
      "type: april_grid, tags: [4, 3], tag_size_m: 0.12, spacing_ratio: 0.3, first_id: 60, plate_size_m: [0.8, 0.6]",
      40);
  ExpectFound(
      "type: aruco_grid, tags: [3, 2], tag_size_m: 0.16, spacing_ratio: 0.3, dictionary: DICT_4X4_50, "
      "ids: [7, 3, 40, 1, 0, 22], plate_size_m: [0.8, 0.6]",
      20);
  ExpectFound(
      "type: charuco, squares: [7, 5], square_size_m: 0.09, marker_size_m: 0.065, dictionary: DICT_5X5_100, "
      "first_id: 51, plate_size_m: [0.8, 0.6]",
      20);
}

// By itself it says how it is turned only as its family draws it.
TEST(SimPrintedBoards, ASingleTagIsTheRightWayRound) {
  const std::string plate = ", plate_size_m: [0.8, 0.6], plate_offset_m: [0.1, 0.05]";
  ExpectFound("type: april_grid, tags: [1, 1], tag_size_m: 0.35, first_id: 7" + plate, 4);
  ExpectFound("type: aruco_grid, tags: [1, 1], tag_size_m: 0.35, dictionary: DICT_4X4_50" + plate, 4);
}

TEST(SimPrintedBoards, MarkersOfOtherIdsAreAnotherBoard) {
  const Experiment experiment = ExperimentOf(
      "type: april_grid, tags: [4, 3], tag_size_m: 0.12, spacing_ratio: 0.3, first_id: 60, plate_size_m: [0.8, 0.6]");
  Target other = experiment.rig.boards.front().target;
  other.marker_ids.clear();
  const Found found = FindAll(experiment, other);
  EXPECT_GE(found.boards, 5);
  EXPECT_EQ(found.missed, found.boards);
}

TEST(SimPrintedBoards, APatternNeedNotBeInTheMiddleOfItsPlate) {
  for (const std::string& print : {std::string("inner_corners: [6, 4], square_size_m: 0.07"),
                                   std::string("type: april_grid, tags: [3, 2], tag_size_m: 0.12, spacing_ratio: 0.3")})
    ExpectFound(print + ", plate_size_m: [0.9, 0.6], plate_offset_m: [0.15, -0.08]", 20);
}

TEST(SimPrintedBoards, ADictionaryThatIsTooSmallIsRefused) {
  const auto rig = ReadRig(RigYaml("type: aruco_grid, tags: [3, 2], tag_size_m: 0.16, spacing_ratio: 0.3, dictionary: "
                                   "DICT_4X4_50, first_id: 48, plate_size_m: [0.8, 0.6]"),
                           "rig.yaml");
  ASSERT_FALSE(rig);
  EXPECT_THAT(rig.error().what, HasSubstr("id 50"));
}

// What is blurred keeps its black: over a whole pattern the blurred part is as much as the sharp one.
TEST(PrintedPattern, BlurSpreadsBlackAndAddsNone) {
  Target target{TargetId("board"), 3, 3, 0.03, 0.0, ""};
  target.kind = TargetKind::kCircleGrid;
  target.diameter_m = 0.015;
  const PrintedPattern pattern = PrintedPattern::Of(target).value();
  const SoftEdge edge;
  double sharp = 0, blurred = 0;
  for (double a = -0.06; a <= 0.06; a += 0.0005)
    for (double b = -0.06; b <= 0.06; b += 0.0005) {
      sharp += pattern.IsBlack({a, b}) ? 1 : 0;
      blurred += pattern.Black({static_cast<float>(a), static_cast<float>(b)}, {0.001f, 0.0015f}, edge);
    }
  EXPECT_NEAR(blurred / sharp, 1, 0.06);  // rims are taken as straight
  EXPECT_NEAR(sharp * 0.0005 * 0.0005, 9 * M_PI * 0.015 * 0.015 / 4, 2e-5);
}

}  // namespace
}  // namespace rigcal::sim
