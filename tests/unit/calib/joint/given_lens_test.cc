// Cameras that were given what is not their lens: the virtual robot sees through its own.
#include <gmock/gmock.h>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

Sensor& SensorNamed(const std::string& name, FeatureSession& session) {
  for (Sensor& sensor : session.header.sensors)
    if (sensor.id == SensorId(name)) return sensor;
  throw std::out_of_range(name);
}

void Exchange(const std::string& a, const std::string& b, FeatureSession& session) {
  std::swap(SensorNamed(a, session).intrinsics, SensorNamed(b, session).intrinsics);
  std::swap(SensorNamed(a, session).intrinsics_sigma, SensorNamed(b, session).intrinsics_sigma);
}

TEST(GivenLens, ExchangedIntrinsicsAreToldAndPosesAreByNewOnes) {
  for (const auto kind : {sim::IntrinsicsKind::kCalibrated, sim::IntrinsicsKind::kExact}) {
    sim::Options options = WithSeed(5);
    options.intrinsics = kind;
    FeatureSession session = Visit(options);
    Exchange("front_left", "front_right", session);
    const SessionEstimate estimate = EstimateFrom(session);
    EXPECT_LT(WorstT2(session, estimate), 30.0);  // 6 are expected; thousands by what was given
    EXPECT_THAT(estimate.moved, testing::IsEmpty());
    ASSERT_EQ(estimate.contradicted_lenses.size(), 2u);
    for (const ContradictedLens& lens : estimate.contradicted_lenses) {
      EXPECT_NEAR(lens.shift_px, 14.0, 5.0);
      EXPECT_NEAR(lens.shift_rad, lens.shift_px / 1450.0, 1e-4);
    }
    EXPECT_EQ(estimate.contradicted_lenses[0].like, estimate.contradicted_lenses[1].camera);
    EXPECT_EQ(estimate.contradicted_lenses[1].like, estimate.contradicted_lenses[0].camera);
  }
}

TEST(GivenLens, AWrongFocalLengthIsToldOfItsCameraAlone) {
  FeatureSession session = Visit(WithSeed(5));
  CameraIntrinsics& given = *SensorNamed("left_front", session).intrinsics;
  given.fx_px *= 1.004, given.fy_px *= 1.004;
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 30.0);
  ASSERT_EQ(estimate.contradicted_lenses.size(), 1u);
  EXPECT_EQ(estimate.contradicted_lenses[0].camera, SensorId("left_front"));
  EXPECT_TRUE(estimate.contradicted_lenses[0].like.empty());
}

// Prints are judged before lenses, and anew once these are known to be wrong.
TEST(GivenLens, AStretchedPrintBehindExchangedIntrinsicsIsStillFound) {
  sim::Options options = WithSeed(5);
  options.disturb.board_stretch_ratio = 0.003;
  FeatureSession session = Visit(options);
  Exchange("front_left", "front_right", session);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 30.0);
  EXPECT_EQ(estimate.contradicted_lenses.size(), 2u);
  ASSERT_FALSE(estimate.stretches.empty());
  for (const PrintStretch& stretch : estimate.stretches)
    EXPECT_NEAR(stretch.longer_ratio, 0.003, 4 * stretch.sigma_ratio) << stretch.board.str();
}

TEST(GivenLens, IsNotContradictedByABumpOrALensThatBends) {
  sim::Options bumped = WithSeed(6);
  bumped.bump = SensorId("front_right");
  bumped.bump_m = 0.02;
  sim::Options bent = WithSeed(6);
  bent.disturb.lens_misfit_px = 0.1;
  for (const sim::Options& options : {WithSeed(6), bumped, bent})
    EXPECT_THAT(EstimateFrom(Visit(options)).contradicted_lenses, testing::IsEmpty());
}

}  // namespace
}  // namespace rigcal::calib::joint
