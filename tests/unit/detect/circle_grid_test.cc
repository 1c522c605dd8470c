// Grids of circles in rendered pictures: found where they are, whole or not at all.
#include <gmock/gmock.h>

#include "tests/unit/detect/circles.h"

namespace rigcal::detect {
namespace {

using testing::HasSubstr;

constexpr double kDegree = M_PI / 180;

// In the middle of the picture, tilted about an axis that turns with `step`.
Scene Tilted(const Circles& board, double tilt_deg, int step) {
  const double about = 1.3 * step;
  Scene scene = Looking(board.Middle_m(), 0.42, 0.3 + 0.8 * step, tilt_deg * kDegree * std::cos(about),
                        tilt_deg * kDegree * std::sin(about));
  scene.seed = static_cast<std::uint64_t>(step + 1);
  return scene;
}

BoardView FoundIn(const Scene& scene, const Circles& board) {
  return DetectIn(Photographed(scene, Drawn(board)), TargetOf(board)).view;
}

// Of a board that looks alike when turned, against the turn that fits best.
Errors LeastErrors(const BoardView& view, const Scene& scene, const Circles& board) {
  Errors least{HUGE_VAL, HUGE_VAL};
  for (const int quarters : board.asymmetric           ? std::vector<int>{0}
                            : board.cols == board.rows ? std::vector<int>{0, 1, 2, 3}
                                                       : std::vector<int>{0, 2})
    if (const Errors errors = ErrorsOf(view, TruthTurned(scene, board, quarters)); errors.rms_px < least.rms_px)
      least = errors;
  return least;
}

class CircleGrids : public testing::TestWithParam<Circles> {};
INSTANTIATE_TEST_SUITE_P(Kinds, CircleGrids, testing::Values(Circles{}, Circles{5, 5}, Asymmetric()),
                         [](const auto& one) {
                           return (one.param.asymmetric ? "asymmetric" : "grid") + std::to_string(one.param.cols);
                         });

TEST_P(CircleGrids, AreFoundAtTiltsUpTo60Degrees) {
  for (int tilt_deg = 0; tilt_deg <= 60; tilt_deg += 15)
    for (int step = 0; step < 4; ++step) {
      const Scene scene = Tilted(GetParam(), tilt_deg, step);
      const BoardView view = FoundIn(scene, GetParam());
      ASSERT_TRUE(view.found) << tilt_deg << " " << step << ": " << view.why_not;
      EXPECT_EQ(view.corner_idx.size(), static_cast<std::size_t>(GetParam().cols * GetParam().rows));
      const Errors errors = LeastErrors(view, scene, GetParam());
      EXPECT_LT(errors.rms_px, 0.03) << tilt_deg << " " << step;
      EXPECT_LT(errors.largest_px, 0.12) << tilt_deg << " " << step;
    }
}

TEST_P(CircleGrids, BlurAndNoiseLeaveThemInPlace) {
  for (const auto& [blur_px, noise_grey, rms_px] : {std::tuple(2.0, 2.0, 0.05), {0.7, 10.0, 0.1}, {1.5, 6.0, 0.1}}) {
    Scene scene = Tilted(GetParam(), 30, 2);
    scene.blur_px = blur_px, scene.noise_grey = noise_grey;
    const BoardView view = FoundIn(scene, GetParam());
    ASSERT_TRUE(view.found) << blur_px << " " << noise_grey << ": " << view.why_not;
    EXPECT_LT(LeastErrors(view, scene, GetParam()).rms_px, rms_px) << blur_px << " " << noise_grey;
  }
}

TEST_P(CircleGrids, LightOnesOnDarkGroundAreFoundAlike) {
  Circles board = GetParam();
  board.inverted = true;
  const Scene scene = Tilted(board, 25, 1);
  const BoardView view = FoundIn(scene, board);
  ASSERT_TRUE(view.found) << view.why_not;
  EXPECT_LT(LeastErrors(view, scene, board).rms_px, 0.03);
}

// Another count of circles could be any part of the board.
TEST_P(CircleGrids, PartOfOneIsNotFound) {
  const Scene scene = Tilted(GetParam(), 20, 1);
  for (const int idx : {0, 1, 12, GetParam().cols * GetParam().rows - 1}) {
    const Pattern covered = Covered(Drawn(GetParam()), GetParam().Centre_m(idx), GetParam().diameter_m);
    const BoardView view = DetectIn(Photographed(scene, covered), TargetOf(GetParam())).view;
    EXPECT_FALSE(view.found) << idx;
    EXPECT_THAT(view.why_not, HasSubstr("circles in the picture")) << idx;
  }
  Scene cut = scene;
  cut.t_m.x() += 0.22;
  EXPECT_FALSE(FoundIn(cut, GetParam()).found);
}

TEST_P(CircleGrids, ACircleThatIsCoveredInPartIsNotFound) {
  const Scene scene = Tilted(GetParam(), 20, 3);
  const double radius_m = GetParam().diameter_m / 2;
  for (const int idx : {0, 9}) {
    const Eigen::Vector2d beside_m = GetParam().Centre_m(idx) + Eigen::Vector2d(1.1, 0.4) * radius_m;
    const Pattern covered = Covered(Drawn(GetParam()), beside_m, 0.6 * radius_m);
    EXPECT_FALSE(DetectIn(Photographed(scene, covered), TargetOf(GetParam())).view.found) << idx;
  }
}

TEST(CircleGrid, OfOtherCountsIsRefusedInWords) {
  Target target = TargetOf(Circles{});
  const cv::Mat picture = Photographed(Tilted({}, 20, 1), Drawn(Circles{}));
  target.rows = 6;
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("35 circles hang together in "));
  target.rows = 4;
  EXPECT_THAT(DetectIn(picture, target).view.why_not, HasSubstr("and it has 28: check circles"));
  target = TargetOf(Asymmetric());
  EXPECT_FALSE(DetectIn(picture, target).view.found);
  EXPECT_THAT(DetectIn(Photographed(Tilted({}, 0, 0), [](double, double) { return kLight; }), target).view.why_not,
              HasSubstr("no circles that lie as on it"));
}

// Which of them the session means, nobody can tell.
TEST(CircleGrid, TwoAlikeInOnePictureAreRefused) {
  const Circles board{5, 4, 0.02, 0.01, false, false};
  const Pattern one = Drawn(board);
  const Pattern two = [&](double x_m, double y_m) { return one(x_m < 0.1 ? x_m : x_m - 0.13, y_m); };
  const Scene scene = Looking({0.1, 0.03}, 0.42, 0.1, 0.2);
  EXPECT_THAT(DetectIn(Photographed(scene, two), TargetOf(board)).view.why_not, HasSubstr("that is the only one"));
  EXPECT_TRUE(DetectIn(Photographed(scene, one), TargetOf(board)).view.found);
}

// The product's own symmetry and the pictures agree: what is found is one of the turns that TurnedIndex() names.
TEST(CircleGrid, AgreesWithTheTargetsSymmetry) {
  for (const Circles& board : {Circles{}, Circles{5, 5}, Asymmetric()}) {
    const Target target = TargetOf(board);
    for (int step = 0; step < 5; ++step) {
      const Scene scene = Tilted(board, 25, step);
      const BoardView view = FoundIn(scene, board);
      ASSERT_TRUE(view.found) << view.why_not;
      int agreeing = 0;
      for (int turn = 0; turn < SymmetryOf(target); ++turn) {
        std::map<int, Eigen::Vector2d> truth;
        for (int idx = 0; idx < board.cols * board.rows; ++idx)
          truth[TurnedIndex(target, idx, turn)] = scene.Pixel(board.Centre_m(idx));
        agreeing += ErrorsOf(view, truth).largest_px < 0.3 ? 1 : 0;
      }
      EXPECT_EQ(agreeing, 1) << board.cols << " x " << board.rows;
      if (SymmetryOf(target) == 1) continue;
      EXPECT_LT(view.corners_px.front().sum(), view.corners_px.back().sum());
    }
  }
}

TEST(CircleGrid, IsAnotherKeyOfTheCacheWithAnotherDiameter) {
  Target target = TargetOf(Circles{});
  const std::string key = DetectorKey(target);
  target.diameter_m = 0.012;
  EXPECT_NE(DetectorKey(target), key);
  target = TargetOf(Circles{});
  target.kind = TargetKind::kAsymmetricCircleGrid;
  EXPECT_NE(DetectorKey(target), key);
}

}  // namespace
}  // namespace rigcal::detect
