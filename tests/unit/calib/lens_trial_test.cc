// Lens models judged on pictures that they were not fitted to, and distortion that no lens has. Pictures are drawn by
// OpenCV's projection.
#include "server/calib/camera/lens_trial.h"

#include <gmock/gmock.h>

#include <cmath>

#include "server/calib/camera/lens_bounds.h"
#include "server/calib/core/selection.h"
#include "tests/unit/calib/virtual_pair.h"

namespace rigcal::calib {
namespace {

using testing::HasSubstr;

constexpr double kSigma_px = 0.1;
const double kNoise_px = kSigma_px * std::sqrt(2.0);  // of a corner's distance

CameraProblem Pictures(const VirtualPair& pair, const std::vector<Se3>& boards, CameraModel taken_as, unsigned seed) {
  CameraProblem problem = CameraOf(Photographed(pair, boards, kSigma_px, seed), &StereoCapture::a);
  problem.camera.camera_model = taken_as;
  return problem;
}

// A rational lens that radtan follows to a quarter of a pixel, as far out as SpreadBoards reach.
VirtualPair NearlyRadtan() {
  VirtualPair pair = PairOf(CameraModel::kPinholeRational);
  pair.a.fx_px = pair.a.fy_px = 330;
  pair.a.distortion = {0.5, 0.05, 0.001, -0.0007, 0.0, 0.8, 0.15, 0.01};
  return pair;
}

// Every capture by itself.
std::map<CaptureId, int> SingleGroups(const CameraProblem& problem) {
  std::map<CaptureId, int> groups;
  for (const auto& [capture, view] : problem.views) groups.emplace(capture, static_cast<int>(groups.size()));
  return groups;
}

LensTrial Tried(const CameraProblem& problem) {
  const auto estimate = EstimateCamera(problem);
  EXPECT_TRUE(estimate) << estimate.error().what;
  return estimate ? TryLenses(problem, *estimate, SingleGroups(problem)) : LensTrial();
}

double LeftOut_px(const LensTrial& trial, CameraModel model) {
  for (const LensCandidate& one : trial.candidates)
    if (one.model == model && one.left_out_rms_px) return *one.left_out_rms_px;
  return std::numeric_limits<double>::infinity();
}

// Waves of 1.5 and 2.3 lengths over the picture, which no series about the middle follows.
void Bend(double amplitude_px, CameraProblem& problem) {
  for (auto& [capture, view] : problem.views)
    for (Eigen::Vector2d& uv_px : view.corners_px) {
      const Eigen::Vector2d turn = 2 * M_PI * uv_px / 640;
      uv_px += amplitude_px *
               Eigen::Vector2d(std::sin(2.3 * turn.x() + 0.9 * turn.y()), std::cos(1.5 * turn.y() - 2.0 * turn.x()));
    }
}

TEST(LensTrial, ARationalLensTakenAsRadtanIsProposedWithWhatItGains) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const LensTrial trial = Tried(Pictures(NearlyRadtan(), SpreadBoards(30), CameraModel::kPinholeRadtan, seed));
    EXPECT_EQ(trial.proposed, CameraModel::kPinholeRational) << seed;
    EXPECT_FALSE(trial.given);
    EXPECT_EQ(trial.captures, 30);
    EXPECT_EQ(*trial.own_left_out_rms_px, LeftOut_px(trial, CameraModel::kPinholeRadtan));
    EXPECT_NEAR(LeftOut_px(trial, CameraModel::kPinholeRational), kNoise_px, 0.2 * kNoise_px);
    EXPECT_GT(*trial.own_left_out_rms_px, 1.2 * LeftOut_px(trial, CameraModel::kPinholeRational));
  }
}

TEST(LensTrial, WhereNoModelFollowsTheBendNoneIsProposed) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    CameraProblem problem = Pictures(VirtualPair(), TiltedBoards(30), CameraModel::kPinholeRadtan, seed);
    Bend(0.2, problem);
    const LensTrial trial = Tried(problem);
    EXPECT_EQ(trial.candidates.size(), 3U);
    EXPECT_FALSE(trial.proposed) << seed << " " << *trial.own_left_out_rms_px;
    EXPECT_GT(*trial.own_left_out_rms_px, 1.1 * kNoise_px) << "the pictures are not bent";
  }
}

TEST(LensTrial, ALensOfItsOwnModelStaysIt) {
  for (const CameraModel model : {CameraModel::kPinholeRadtan, CameraModel::kPinholeRational, CameraModel::kFisheyeKb4,
                                  CameraModel::kEucm, CameraModel::kDoubleSphere}) {
    const auto boards = model == CameraModel::kPinholeRadtan ? TiltedBoards(24) : SpreadBoards(24);
    const LensTrial trial = Tried(Pictures(PairOf(model), boards, model, 7));
    EXPECT_FALSE(trial.proposed) << NameOf(model);
    EXPECT_EQ(trial.candidates.size(), IsSphere(model) ? 4U : 3U) << NameOf(model);
    EXPECT_NEAR(*trial.own_left_out_rms_px, kNoise_px, 0.2 * kNoise_px) << NameOf(model);
  }
}

// A lens of more than 90 degrees by a fisheye's series, given as the radtan that OpenCV's users would make of it.
TEST(LensTrial, AWideLensGivenAsRadtanIsToBeCalibratedAnew) {
  CameraProblem problem = Pictures(PairOf(CameraModel::kFisheyeKb4), SpreadBoards(30), CameraModel::kPinholeRadtan, 2);
  const auto radtan = EstimateCamera(problem);
  ASSERT_TRUE(radtan) << radtan.error().what;
  problem.camera.intrinsics = radtan->intrinsics;
  const LensTrial trial = Tried(problem);
  EXPECT_TRUE(trial.given);
  ASSERT_TRUE(trial.proposed);
  EXPECT_NE(*trial.proposed, CameraModel::kPinholeRadtan);
  EXPECT_NEAR(LeftOut_px(trial, CameraModel::kFisheyeKb4), kNoise_px, 0.1 * kNoise_px);
  EXPECT_LE(LeftOut_px(trial, *trial.proposed), 1.05 * LeftOut_px(trial, CameraModel::kFisheyeKb4));
  EXPECT_GT(*trial.own_left_out_rms_px, 1.2 * LeftOut_px(trial, *trial.proposed));
}

TEST(LensTrial, NumbersThatWereGivenWrongNeedNoOtherModel) {
  const VirtualPair pair;
  CameraProblem problem = Pictures(pair, TiltedBoards(24), CameraModel::kPinholeRadtan, 5);
  problem.camera.intrinsics = pair.a;
  EXPECT_FALSE(Tried(problem).proposed);
  problem.camera.intrinsics->distortion[0] += 0.05;
  const LensTrial trial = Tried(problem);
  EXPECT_EQ(trial.proposed, CameraModel::kPinholeRadtan);
  EXPECT_NEAR(LeftOut_px(trial, CameraModel::kPinholeRadtan), kNoise_px, 0.1 * kNoise_px);
}

TEST(LensTrial, OnePictureThatIsWrongDoesNotDecide) {
  CameraProblem problem = Pictures(NearlyRadtan(), SpreadBoards(30), CameraModel::kPinholeRadtan, 1);
  for (Eigen::Vector2d& uv_px : problem.views[4].second.corners_px) uv_px.x() += 3 * std::sin(0.05 * uv_px.y());
  EXPECT_EQ(Tried(problem).proposed, CameraModel::kPinholeRational);
}

TEST(LensTrial, IsTheSameEveryTime) {
  const CameraProblem problem = Pictures(NearlyRadtan(), SpreadBoards(20), CameraModel::kPinholeRadtan, 1);
  const LensTrial first = Tried(problem), again = Tried(problem);
  ASSERT_EQ(first.candidates.size(), 3U);
  EXPECT_EQ(first.own_left_out_rms_px, again.own_left_out_rms_px);
  EXPECT_EQ(first.proposed, again.proposed);
  for (const LensCandidate& one : first.candidates)
    EXPECT_EQ(one.left_out_rms_px.value_or(-1),
              again.candidates.at(static_cast<std::size_t>(one.model)).left_out_rms_px.value_or(-1));
}

TEST(LensTrial, CapturesOfOneBurstAreNoEvidence) {
  const CameraProblem problem = Pictures(NearlyRadtan(), SpreadBoards(20), CameraModel::kPinholeRadtan, 1);
  std::map<CaptureId, int> groups = SingleGroups(problem);
  for (auto& [capture, group] : groups) group /= 5;
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate);
  EXPECT_TRUE(TryLenses(problem, *estimate, groups).candidates.empty()) << "four groups tell nothing";
}

TEST(LensTrial, CapturesWithoutAGroupTakeNoPart) {
  const CameraProblem problem = Pictures(VirtualPair(), TiltedBoards(20), CameraModel::kPinholeRadtan, 1);
  std::map<CaptureId, int> groups = SingleGroups(problem);
  groups.erase(CaptureId("003"));
  const auto estimate = EstimateCamera(problem);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(TryLenses(problem, *estimate, groups).captures, 19);
}

Sensor CameraOfModel(CameraModel model) {
  Sensor camera;
  camera.id = SensorId("front_left");
  camera.camera_model = model;
  return camera;
}

// Corners all over a picture of 640 x 480.
CameraViews Everywhere(CameraModel model) {
  CameraViews views;
  views.width_px = 640, views.height_px = 480;
  views.model = model;
  SeenCorners seen;
  for (int v = 20; v < 480; v += 40)
    for (int u = 20; u < 640; u += 40) seen.idx.push_back(0), seen.uv_px.emplace_back(u, v);
  views.seen.assign(5, seen);
  return views;
}

std::string CodeOf(const CameraIntrinsics& intrinsics) {
  const auto why = WhyAbsurd(CameraOfModel(intrinsics.model), VectorOf(intrinsics), Everywhere(intrinsics.model));
  return why ? why->code : "";
}

TEST(LensBounds, LensesThatThereAreArePassed) {
  EXPECT_EQ(CodeOf(VirtualPair().a), "");
  EXPECT_EQ(CodeOf({300, 300, 319.5, 239.5, {0.25, 0.0, 0, 0, 0}, CameraModel::kPinholeRadtan}), "") << "pincushion";
  EXPECT_EQ(CodeOf(PairOf(CameraModel::kPinholeRational).a), "");
  EXPECT_EQ(CodeOf({288,
                    287,
                    322,
                    238,
                    {7.263, 2.337, 0.0, 0.0001, 0.0379, 7.636, 4.597, 0.3275},
                    CameraModel::kPinholeRational}),
            "")
      << "140 degrees, its halves nearly cancel";
  EXPECT_EQ(CodeOf(PairOf(CameraModel::kFisheyeKb4).a), "");
  EXPECT_EQ(CodeOf({190, 190, 319.5, 239.5, {0, 0, 0, 0}, CameraModel::kFisheyeKb4}), "") << "190 degrees";
  EXPECT_EQ(CodeOf(PairOf(CameraModel::kEucm).a), "");
  EXPECT_EQ(CodeOf(PairOf(CameraModel::kDoubleSphere).a), "");
  EXPECT_EQ(CodeOf({175, 175, 319.5, 239.5, {-0.172, 0.593}, CameraModel::kDoubleSphere}), "") << "beyond 180 degrees";
  EXPECT_EQ(CodeOf({900, 900, 319.5, 239.5, {0.4, 0.0}, CameraModel::kDoubleSphere}), "")
      << "1.4 times as long as told";
}

TEST(LensBounds, NumbersThatNoSphereModelHasAreNamed) {
  const auto why = [](const CameraIntrinsics& lens) {
    const auto found = WhyAbsurd(CameraOfModel(lens.model), VectorOf(lens), Everywhere(lens.model));
    return found ? found->what : "";
  };
  EXPECT_EQ(
      why({300, 300, 319.5, 239.5, {-0.02, 1.0}, CameraModel::kEucm}),
      "The estimated eucm distortion of front_left is that of no lens: alpha -0.02 is not within 0 to 1; below 0 it "
      "bends like a pinhole, or less.");
  EXPECT_THAT(why({300, 300, 319.5, 239.5, {0.6, 0.0}, CameraModel::kEucm}), HasSubstr("beta 0 is not above 0"));
  EXPECT_THAT(why({300, 300, 319.5, 239.5, {-1.0, 0.6}, CameraModel::kDoubleSphere}),
              HasSubstr("xi -1 is not between -1 and 1"));
  EXPECT_THAT(why({300, 300, 319.5, 239.5, {0.9, 1.0}, CameraModel::kEucm}),
              HasSubstr("turns over inside the picture"));
}

TEST(LensBounds, AnEucmLensThatBendsLikeAPinholeIsSentToThatModel) {
  const CameraIntrinsics lens{300, 300, 319.5, 239.5, {-0.001, 1.0}, CameraModel::kEucm};
  Sensor camera = CameraOfModel(CameraModel::kEucm);
  EXPECT_EQ(WhyAbsurd(camera, VectorOf(lens), Everywhere(lens.model))->cure, "Set its model to pinhole_radtan.");
  camera.intrinsics = lens;
  EXPECT_THAT(WhyAbsurd(camera, VectorOf(lens), Everywhere(lens.model))->cure, HasSubstr("given intrinsics"));
}

TEST(LensBounds, DistortionThatNoLensHasIsToldByWhereItIs) {
  EXPECT_EQ(CodeOf({400, 400, 319.5, 239.5, {-0.9, 0, 0, 0, 0}, CameraModel::kPinholeRadtan}), kAbsurdDistortionCode)
      << "turns over";
  EXPECT_EQ(CodeOf({500, 500, 319.5, 239.5, {0, 0, 0, 0, 62}, CameraModel::kPinholeRadtan}), kAbsurdDistortionCode);
  EXPECT_EQ(CodeOf({150, 150, 319.5, 239.5, {0.2, 0.1, 0, 0}, CameraModel::kFisheyeKb4}), "")
      << "farther than an equidistant lens, nearer than a rectilinear one";
  const auto why =
      WhyAbsurd(CameraOfModel(CameraModel::kPinholeRadtan), VectorOf({500, 500, 319.5, 239.5, {0, 0, 0, 0, 62}}),
                Everywhere(CameraModel::kPinholeRadtan));
  ASSERT_TRUE(why);
  EXPECT_THAT(why->what, HasSubstr("The estimated pinhole_radtan distortion of front_left bends rays"));
  EXPECT_THAT(why->cure, HasSubstr("in all corners of the picture"));
}

TEST(LensBounds, DecentringThatNoCameraIsBuiltWithIsToldAsATilt) {
  CameraIntrinsics lens{500, 500, 319.5, 239.5, {-0.1, 0.05, 0.0005, 0.0125, 0}, CameraModel::kPinholeRadtan};
  Sensor camera = CameraOfModel(lens.model);
  EXPECT_EQ(CodeOf(lens), "") << "2.1 deg, of a camera that is sold";
  lens.distortion[2] = 0.018;
  lens.distortion[3] = -0.038;
  const auto why = WhyAbsurd(camera, VectorOf(lens), Everywhere(lens.model));
  ASSERT_TRUE(why);
  EXPECT_EQ(why->code, kAbsurdDistortionCode);
  EXPECT_THAT(why->what, HasSubstr("as if its sensor were tilted by 7.2 deg against its lens"));
  camera.intrinsics = lens;
  EXPECT_FALSE(WhyAbsurd(camera, VectorOf(lens), Everywhere(lens.model))) << "whoever gives them may know";
}

TEST(LensBounds, WhatLiesBeyondTheCornersSeenIsNotJudged) {
  CameraViews views = Everywhere(CameraModel::kPinholeRadtan);
  for (SeenCorners& seen : views.seen)
    for (Eigen::Vector2d& uv_px : seen.uv_px)
      uv_px = Eigen::Vector2d(320, 240) + 0.3 * (uv_px - Eigen::Vector2d(320, 240));
  EXPECT_FALSE(WhyAbsurd(CameraOfModel(CameraModel::kPinholeRadtan),
                         VectorOf({500, 500, 319.5, 239.5, {0, 0, 0, 0, 62}}), views));
}

TEST(LensBounds, GivenIntrinsicsThatTurnOverInsideThePictureFailTheCamera) {
  CameraProblem problem = Pictures(PairOf(CameraModel::kFisheyeKb4), SpreadBoards(20), CameraModel::kPinholeRadtan, 1);
  problem.camera.intrinsics = {300, 300, 322, 238, {-0.9, 0, 0, 0, 0}, CameraModel::kPinholeRadtan};
  const auto estimate = EstimateCamera(problem);
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, kAbsurdDistortionCode);
  EXPECT_THAT(estimate.error().what, HasSubstr("The given pinhole_radtan distortion of front_left turns over inside"));
  EXPECT_THAT(estimate.error().cure, HasSubstr("leave them out to have them estimated"));
}

// Pictures that follow the model well, of a lens that cannot be.
TEST(LensBounds, AnEstimateThatBendsAsNoLensDoesFailsTheCamera) {
  VirtualPair pair;
  pair.a.distortion = {0.3, 12.0, 0, 0, 0};
  const auto estimate = EstimateCamera(Pictures(pair, TiltedBoards(20), CameraModel::kPinholeRadtan, 1));
  ASSERT_FALSE(estimate);
  EXPECT_EQ(estimate.error().code, kAbsurdDistortionCode) << estimate.error().what;
}

}  // namespace
}  // namespace rigcal::calib
