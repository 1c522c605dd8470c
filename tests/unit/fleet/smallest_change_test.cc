// Sessions before which a sensor moved by just what they tell as the smallest change that they see.
#include "server/fleet/as_found/smallest_change.h"

#include <gmock/gmock.h>

#include <functional>

#include "tests/unit/fleet/as_found_rig.h"

namespace rigcal::fleet {
namespace {

using ::testing::ElementsAre;

// The same draws with the right camera moved.
AsFoundInput Moved(AsFoundInput input, int axis, double step) {
  for (KnownPose& pose : input.session.poses)
    if (pose.sensor == kRight) pose.T_ref_sensor = Stepped(pose.T_ref_sensor, Along(axis, step));
  return input;
}

// Of 2000 sessions before which the right camera moved by so many times the smallest change that the same session tells
// without it: in how many it is seen, as a share. `put`: changes what was drawn of a session.
double Seen(
    const Errors& errors, int axis, double times, unsigned seed,
    const std::function<void(AsFoundInput&)>& put = [](AsFoundInput&) {}) {
  Draws draws(seed);
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    AsFoundInput input = Visit(DrawnRig(), DrawnRig(), errors, draws);
    put(input);
    const double smallest = Of(kRight, TestAsFound(input)).smallest(axis);
    const AsFound found = TestAsFound(Moved(input, axis, times * smallest));
    const bool is_right =
        found.relative_to == kLeft && Of(kRight, found).axes[static_cast<std::size_t>(axis)] == FoundState::kDrifted;
    seen += is_right ? 1 : 0;
  }
  return seen / 2000.0;
}

TEST(SmallestChange, IsSeenInNineteenOfTwenty) {
  EXPECT_NEAR(Seen(SomeErrors(), 0, 1.0, 3), 0.95, 0.02);
  EXPECT_NEAR(Seen(SomeErrors(), 5, 1.0, 4), 0.95, 0.02);
  EXPECT_GE(Seen(SomeErrors(), 2, 1.2, 5), 0.99);
  EXPECT_LT(Seen(SomeErrors(), 2, 0.6, 6), 0.5);
}

TEST(SmallestChange, IsSeenInNineteenOfTwentyWhereSigmasAreEstimates) {
  Errors errors = SomeErrors();
  errors.in_use *= 1e-4;
  errors.visit_sigma_m = errors.visit_sigma_rad = 0;
  errors.dof = 20;
  EXPECT_NEAR(Seen(errors, 1, 1.0, 7), 0.95, 0.02);
}

// Three axes of four visits have nine numbers. By the noncentral t it would be 99 %.
TEST(SmallestChange, IsSeenInNineteenOfTwentyWhereFewVisitsTellTheirScatter) {
  Errors errors = SomeErrors();
  errors.visits = 4;
  errors.visit_sigma_m = errors.visit_sigma_rad = 1e-3;
  const auto put = [](AsFoundInput& input) {
    for (KnownPose& pose : input.in_use.poses) pose.scatter_dof = ScatterDof{9, 9};
  };
  EXPECT_NEAR(Seen(errors, 1, 1.0, 53, put), 0.95, 0.02);
}

// 1 mm is assumed: by it alone, it would be 99 % where sensors scatter by half of that.
TEST(SmallestChange, IsSeenInNineteenOfTwentyWhateverVisitsScatterByThatNobodyTells) {
  Errors errors = SomeErrors();
  errors.visits = 1;
  for (const double scatter_m : {3e-4, 5e-4, 1e-3}) {
    errors.visit_sigma_m = scatter_m, errors.visit_sigma_rad = 0.35 * scatter_m;
    EXPECT_NEAR(Seen(errors, 1, 1.0, 51), 0.95, 0.02) << scatter_m;
  }
}

TEST(SmallestChange, WhatNobodyTellsIsNoSmallerForASensorThatMoved) {
  Errors errors = SomeErrors();
  errors.visits = 1;
  Draws draws(52);
  const AsFoundInput input = Visit(DrawnRig(), DrawnRig(), errors, draws);
  const SensorFound before = Of(kTop, TestAsFound(input));
  const AsFound after = TestAsFound(Moved(input, 1, 0.03));
  ASSERT_THAT(Drifted(after), ElementsAre(kRight));
  EXPECT_GT(Of(kTop, after).smallest(0), LimitInSigmas((1 - kAlphaOfRates) * kAsFoundAlpha / 18, 0) * before.sigma(0));
  EXPECT_LT(Of(kTop, after).smallest(0), 1.2 * before.smallest(0)) << "not by what the other was moved";
}

}  // namespace
}  // namespace rigcal::fleet
