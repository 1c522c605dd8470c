// A lens of another model than it is taken for, before boards that look too little tilted by it.
#include "server/calib/camera/lens_choice.h"

#include <gmock/gmock.h>

#include <cmath>

#include "server/calib/core/selection.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

constexpr double kSigma_px = 0.03;

// Much alike, 20 to 55 degrees off the axis of camera a: there a fisheye bends as no pinhole does.
std::vector<Se3> BoardsAside() {
  std::vector<Se3> boards;
  for (int k = 0; k < 14; ++k) {
    const double off = 0.35 + 0.6 * ((k * 5) % 11) / 10.0, range_m = 0.7 + 0.1 * std::sin(1.9 * k);
    const Eigen::Vector3d centre(range_m * std::sin(off), 0.08 * std::cos(1.3 * k), range_m * std::cos(off));
    boards.push_back(BoardAt(VirtualPair(), centre,
                             {0.05 * std::cos(2.1 * k), 0.8 + 0.05 * std::sin(1.7 * k), 0.1 * std::sin(3.1 * k)}));
  }
  return boards;
}

// All facing camera a, but for `lean_rad`.
std::vector<Se3> FrontalBoards(double lean_rad) {
  std::vector<Se3> boards;
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector3d centre(0.1 * std::sin(2.1 * k), 0.06 * std::cos(1.3 * k), 0.45 + 0.1 * std::sin(0.9 * k));
    boards.push_back(BoardAt(VirtualPair(), centre,
                             {lean_rad * std::cos(2.4 * k), lean_rad * std::sin(1.7 * k), 0.1 * std::sin(1.7 * k)}));
  }
  return boards;
}

StereoProblem TakenAsRadtan(StereoProblem problem) {
  problem.camera_a.camera_model = problem.camera_b.camera_model = CameraModel::kPinholeRadtan;
  return problem;
}

StereoProblem FisheyeTakenAsRadtan() {
  return TakenAsRadtan(Photographed(PairOf(CameraModel::kFisheyeKb4), BoardsAside(), kSigma_px, 3));
}

TEST(LensOrTilt, AFisheyeTakenAsAPinholeIsNotAskedForTilt) {
  const auto estimate = EstimateCamera(CameraOf(FisheyeTakenAsRadtan(), &StereoCapture::a));
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, "lens_model_suspected");
  EXPECT_THAT(estimate.error().what, HasSubstr("The lens of front_left is not pinhole_radtan"));
  EXPECT_THAT(estimate.error().cure, testing::StartsWith("Give front_left 'model: fisheye_kb4' in session.yaml"));
  EXPECT_NEAR(estimate.error().figures.at("rms_as_fisheye_kb4_px"), std::sqrt(2.0) * kSigma_px, 0.01);
}

TEST(LensOrTilt, TheFailedPairSaysItOfItsCamera) {
  const Edge edge = EstimateEdge(FisheyeTakenAsRadtan());
  ASSERT_EQ(edge.state, EdgeState::kFailed);
  EXPECT_EQ(edge.diagnoses.at(0).code, "lens_model_suspected") << edge.diagnoses.at(0).what;
  EXPECT_TRUE(edge.figures.contains("rms_as_fisheye_kb4_a_px"));
  EXPECT_FALSE(edge.figures.contains("board_tilt_a_rad"));
}

TEST(LensOrTilt, FrontalBoardsBeforeALensOfItsModelAreToldAsSuch) {
  for (const double lean_rad : {0.0, 0.02, 0.05})
    for (const double sigma_px : {0.0, 0.1, 0.3}) {
      const StereoProblem problem = Photographed(VirtualPair(), FrontalBoards(lean_rad), sigma_px, 5);
      const auto estimate = EstimateCamera(CameraOf(problem, &StereoCapture::a));
      ASSERT_FALSE(estimate) << lean_rad;
      EXPECT_EQ(estimate.error().code, "no_tilt") << lean_rad << " " << sigma_px << " " << estimate.error().what;
      EXPECT_TRUE(estimate.error().figures.contains("board_tilt_rad"));
    }
}

// The corners tell nothing against a lens that bends as theirs did, whichever it is.
TEST(LensOrTilt, FrontalBoardsBeforeAFisheyeMayBeOfAnyLens) {
  const StereoProblem problem =
      TakenAsRadtan(Photographed(PairOf(CameraModel::kFisheyeKb4), FrontalBoards(0.0), 0.1, 5));
  const auto estimate = EstimateCamera(CameraOf(problem, &StereoCapture::a));
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, "no_tilt");
}

// Boards in the middle of the picture leave a rational lens open, which any lens fits as well: none is better.
TEST(LensOrTilt, ALensThatItsViewsLeaveOpenIsNotCalledAnother) {
  VirtualPair pair;
  pair.a.model = CameraModel::kPinholeRational;
  pair.a.distortion.resize(8);
  const auto estimate = EstimateCamera(CameraOf(Photographed(pair, TiltedBoards(8), 0.2, 3), &StereoCapture::a));
  ASSERT_FALSE(estimate);
  EXPECT_TRUE(estimate.error().figures.empty()) << estimate.error().code << ": " << estimate.error().cure;
}

TEST(FocalTrials, FindWhatFrontalBoardsLeaveOfTheLens) {
  const auto views = [](const StereoProblem& problem) { return ViewsOf(CameraOf(problem, &StereoCapture::a)); };
  EXPECT_LT(LeastRmsOverFocals_px(views(Photographed(VirtualPair(), FrontalBoards(0.0), 0, 1))), 0.001);
  EXPECT_LT(LeastRmsOverFocals_px(views(Photographed(VirtualPair(), FrontalBoards(0.0), 0.2, 1))),
            1.05 * 0.2 * std::sqrt(2.0));
  EXPECT_GT(LeastRmsOverFocals_px(views(FisheyeTakenAsRadtan())), 2 * std::sqrt(2.0) * kSigma_px);
}

}  // namespace
}  // namespace rigcal::calib
