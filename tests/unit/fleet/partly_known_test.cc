// As found: sensors of which some directions were not measured, as on a level floor, along the others.
#include "server/fleet/as_found/partly_known.h"

#include <gmock/gmock.h>

#include "tests/unit/fleet/as_found_rig.h"

namespace rigcal::fleet {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const SensorId kBody("body");
constexpr double kSigma = 2e-4;  // m and rad, of either side

// Not along an axis of the sensor's own.
Vector6d Height() {
  Vector6d height = Vector6d::Zero();
  height << 0.3, -0.2, 0.9, 0, 0, 0;
  return height.normalized();
}
Matrix6d Across(const Vector6d& open) { return Matrix6d::Identity() - open * open.transpose(); }

PartlyKnown SideOf(const Vector6d& step, const Vector6d& open, Draws& draws) {
  PartlyKnown side;
  side.sensor = kBody;
  const Vector6d error = Across(open) * kSigma * draws.Normal(6);
  side.T_ref_sensor = Stepped(PlacedAt(-0.2, 0.3, -0.5, {0.1, 0.3, 1}, 0.9), step + error);
  side.covariance = kSigma * kSigma * Across(open);
  side.open = {open / open.cwiseAbs().maxCoeff()};
  return side;
}

// Sensors known whole as drawn, and the body, which is `step` away from where it was.
AsFoundInput VisitOf(const Vector6d& step, Draws& draws, const KnownPoses& is = DrawnRig()) {
  AsFoundInput input = Visit(DrawnRig(), is, SomeErrors(), draws);
  input.assumed_scatter = {0.0, 0.0};
  input.parts = {{SideOf(Vector6d::Zero(), Height(), draws), SideOf(step, Height(), draws)}};
  return input;
}

TEST(PartlyKnown, AMoveAlongWhatWasMeasuredIsTold) {
  Draws draws(60);
  const Vector6d sideways = Across(Height()) * Along(tangent::kX, 0.02);
  const AsFound found = TestAsFound(VisitOf(sideways, draws));
  EXPECT_THAT(Drifted(found), ElementsAre(kBody));
  const SensorFound& body = Of(kBody, found);
  EXPECT_NEAR(body.change.head<3>().norm(), sideways.head<3>().norm(), 1e-3);
  EXPECT_EQ(body.or_else, SensorId()) << "three others did not move against the reference";
  EXPECT_EQ(found.tests, 18 + 6) << "no axis of the body's own lies along the height";
  EXPECT_THAT(AsFoundText(found, {}), ::testing::HasSubstr("body moved"));
}

TEST(PartlyKnown, WhatBothHoldAlongWhatIsOpenIsNoMove) {
  Draws draws(61);
  const AsFound found = TestAsFound(VisitOf(0.06 * Height(), draws));
  EXPECT_THAT(Drifted(found), IsEmpty());
  EXPECT_EQ(Of(kBody, found).state, FoundState::kUnchanged);
}

TEST(PartlyKnown, AnAxisAlongWhatIsOpenIsNotTested) {
  Draws draws(62);
  AsFoundInput input = VisitOf(Vector6d::Zero(), draws);
  const Vector6d z = Vector6d::Unit(tangent::kZ);
  input.parts = {{SideOf(Vector6d::Zero(), z, draws), SideOf(0.05 * z, z, draws)}};
  const AsFound found = TestAsFound(input);
  EXPECT_EQ(found.tests, 18 + 5);
  EXPECT_EQ(Of(kBody, found).axes[tangent::kZ], FoundState::kNotMeasured);
  EXPECT_EQ(Of(kBody, found).axes[tangent::kX], FoundState::kUnchanged);
}

// The floor of the second visit is not quite the first one's: what both hold shows in what was measured.
TEST(PartlyKnown, DirectionsThatAreAlmostOneAreNoMoveEither) {
  Draws draws(63);
  AsFoundInput input = VisitOf(Vector6d::Zero(), draws);
  const Vector6d z = Vector6d::Unit(tangent::kZ), tilted = (z + Along(tangent::kX, 0.03)).normalized();
  input.parts = {{SideOf(Vector6d::Zero(), z, draws), SideOf(0.05 * tilted, tilted, draws)}};
  EXPECT_THAT(Drifted(TestAsFound(input)), IsEmpty());
}

TEST(PartlyKnown, WhatIsHeldFarApartIsNotTested) {
  Draws draws(64);
  const AsFound found = TestAsFound(VisitOf(0.3 * Height(), draws));
  EXPECT_EQ(Of(kBody, found).state, FoundState::kNotMeasured);
  EXPECT_EQ(found.tests, 18);
}

// Open on one side only: along that nobody can tell.
TEST(PartlyKnown, WhatOneSideDidNotMeasureIsNotTested) {
  Draws draws(65);
  AsFoundInput input = VisitOf(0.05 * Height() + Along(tangent::kRx, 0.01), draws);
  input.parts.front().in_use.open.clear();
  input.parts.front().in_use.covariance = kSigma * kSigma * Matrix6d::Identity();
  const AsFound found = TestAsFound(input);
  EXPECT_THAT(Drifted(found), ElementsAre(kBody));
  EXPECT_LT(Of(kBody, found).change.head<3>().norm(), 0.002);
  EXPECT_NEAR(Of(kBody, found).change.tail<3>().norm(), 0.01, 0.002);
}

TEST(PartlyKnown, OfTwoSensorsEitherMayHaveMoved) {
  Draws draws(66);
  AsFoundInput input = VisitOf(Along(tangent::kRy, 0.02), draws);
  input.session = {kLeft, {}, {}};
  const AsFound found = TestAsFound(input);
  EXPECT_EQ(found.relative_to, kLeft);
  EXPECT_EQ(found.tests, 6);
  EXPECT_EQ(Of(kBody, found).or_else, kLeft);
  EXPECT_EQ(Of(kRight, found).state, FoundState::kNotMeasured);
}

// The two that are known whole moved against each other: neither is a place to tell the body from.
TEST(PartlyKnown, OfTwoOthersOfWhichOneMovedNeitherVouches) {
  Draws draws(70);
  const Vector6d away = Across(Height()) * Along(tangent::kX, 0.05);
  AsFoundInput input = VisitOf(away, draws, Bumped(DrawnRig(), kRight, Along(tangent::kY, 0.03)));
  const auto is_one = [](const SensorId& sensor) { return sensor == kLeft || sensor == kRight; };
  input.in_use = Some(input.in_use, is_one), input.session = Some(input.session, is_one);
  const AsFound found = TestAsFound(input);
  EXPECT_EQ(Of(kBody, found).state, FoundState::kDrifted);
  EXPECT_EQ(Of(kBody, found).or_else, found.relative_to);
}

// The bumped reference is not the body's move.
TEST(PartlyKnown, IsSeenFromWhatDidNotMove) {
  Draws draws(67);
  const Vector6d bump = Along(tangent::kY, 0.03);
  AsFoundInput input = VisitOf(Vector6d::Zero(), draws, Bumped(DrawnRig(), kLeft, bump));
  Se3& T_ref_body = input.parts.front().session.T_ref_sensor;
  T_ref_body = Stepped({}, bump).Inverse() * T_ref_body;
  EXPECT_THAT(Drifted(TestAsFound(input)), ElementsAre(kLeft));
}

TEST(PartlyKnown, WhatWasMovedOnPurposeIsNotTested) {
  Draws draws(68);
  AsFoundInput input = VisitOf(Along(tangent::kX, 0.05), draws);
  input.moved_on_purpose = {kBody};
  EXPECT_EQ(Of(kBody, TestAsFound(input)).state, FoundState::kMovedOnPurpose);
  input.moved_on_purpose = {kLeft};  // told from the one that was moved
  EXPECT_EQ(Of(kBody, TestAsFound(input)).state, FoundState::kNotMeasured);
}

// At odds of 1 % over all axes, those of the part among them: 20 of 2000 on average.
TEST(PartlyKnown, FalseAlarmsAreNoMoreThanAlpha) {
  Draws draws(69);
  int alarms = 0;
  for (int i = 0; i < 2000; ++i) {
    AsFoundInput input = VisitOf(0.03 * draws.Normal(1)(0) * Height(), draws);
    input.alpha = 0.01;
    alarms += StateOf(TestAsFound(input)) == FoundState::kDrifted ? 1 : 0;
  }
  EXPECT_LE(alarms, 45) << alarms;
  EXPECT_GE(alarms, 3);
}

}  // namespace
}  // namespace rigcal::fleet
