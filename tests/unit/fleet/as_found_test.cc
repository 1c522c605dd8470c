// The calibration in use against sessions that are drawn: false alarms, what is seen, who is named.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/unit/fleet/as_found_rig.h"

namespace rigcal::fleet {
namespace {

using ::testing::ElementsAre;

// How many of 2000 sessions in which nothing moved accuse a sensor, at odds of 1 % for the whole session.
int FalseAlarms(const Errors& errors, unsigned seed) {
  Draws draws(seed);
  int alarms = 0;
  for (int i = 0; i < 2000; ++i) {
    AsFoundInput input = Visit(DrawnRig(), DrawnRig(), errors, draws);
    input.alpha = 0.01;
    alarms += StateOf(TestAsFound(input)) == FoundState::kDrifted ? 1 : 0;
  }
  return alarms;
}

TEST(AsFound, FalseAlarmsAreNoMoreThanAlpha) {
  const int alarms = FalseAlarms(SomeErrors(), 1);
  EXPECT_LE(alarms, 45) << alarms;  // more has odds of 1e-6 at 20 on average
  EXPECT_GE(alarms, 3);             // nor is it blind
}

// A year after the newest visit a sensor that goes on from visit to visit is known the less.
TEST(AsFound, PosesOfALaterDayAreKnownTheLessTheFurtherTheyWalk) {
  GraphSolution solution;
  const SensorId left("left"), right("right");
  for (const SensorId& sensor : {left, right}) {
    SensorPose pose;
    pose.sensor = sensor, pose.known = true;
    if (sensor == right) pose.covariance = 1e-8 * Matrix6d::Identity();
    pose.fused = FusedPose();
    pose.fused->walk_m_per_sqrt_day = 1e-4, pose.fused->walk_rad_per_sqrt_day = 2e-4;
    solution.poses.push_back(pose);
  }
  KnownPoses poses = PosesOf(solution, left);
  WalkOn(solution, -3.0, poses);
  EXPECT_NEAR(poses.covariance(0, 0), 1e-8, 1e-20);
  WalkOn(solution, 90.0, poses);
  EXPECT_NEAR(poses.covariance(0, 0), 1e-8 + 90 * 1e-8, 1e-15);
  EXPECT_NEAR(poses.covariance(5, 5), 1e-8 + 90 * 4e-8, 1e-15);
}

TEST(AsFound, FalseAlarmsAreNoMoreThanAlphaWhereSigmasAreEstimatesThemselves) {
  Errors errors = SomeErrors();
  errors.in_use *= 1e-4;
  errors.visit_sigma_m = errors.visit_sigma_rad = 0;
  errors.dof = 10;
  const int alarms = FalseAlarms(errors, 2);
  EXPECT_LE(alarms, 45);
  EXPECT_GE(alarms, 3);
}

// Robots whose sensors sit elsewhere on each visit, by more than a session errs, and few visits to tell so.
TEST(AsFound, FalseAlarmsAreNoMoreThanAlphaHoweverFewVisitsAreInUse) {
  Errors errors = SomeErrors();
  errors.visit_sigma_m = 5e-4, errors.visit_sigma_rad = 3.5e-4;
  for (const int visits : {1, 2, 3, 5, 8}) {
    errors.visits = visits;
    EXPECT_LE(FalseAlarms(errors, 30 + static_cast<unsigned>(visits)), 45) << visits << " visits";
  }
}

TEST(AsFound, ABumpBeyondWhatVisitsMayScatterByIsSeenOnTheSecondVisit) {
  Errors errors = SomeErrors();
  errors.visits = 1;
  Draws draws(40);
  const AsFound found = TestAsFound(Visit(DrawnRig(), Bumped(DrawnRig(), kRight, Along(1, 0.02)), errors, draws));
  EXPECT_THAT(Drifted(found), ElementsAre(kRight));
  EXPECT_GT(SmallestSeen_m(found), 0.005);
}

// 0.5 mm and 0.2 mrad from visit to visit, as sure as 40 numbers are, of each sensor.
PooledScatter PoolOfAll() {
  PooledScatter pooled;
  for (const SensorId& sensor : {kRear, kRight, kTop}) pooled[sensor] = {{25e-8, 1e-8, 40.0}, {4e-8, 1e-8, 40.0}, 9};
  return pooled;
}

AsFoundInput FirstVisit(unsigned seed) {
  Errors errors = SomeErrors();
  errors.visits = 1;
  errors.visit_sigma_m = 5e-4, errors.visit_sigma_rad = 2e-4;
  Draws draws(seed);
  return Visit(DrawnRig(), DrawnRig(), errors, draws);
}

TEST(AsFound, OfOneVisitOtherRobotsTellTheScatter) {
  AsFoundInput input = FirstVisit(41);
  const AsFound assumed = TestAsFound(input);
  input.pooled_scatter = PoolOfAll();
  const AsFound found = TestAsFound(input);
  EXPECT_EQ(found.visits, 1);
  EXPECT_EQ(found.scatter_robots, 9);
  EXPECT_EQ(assumed.scatter_robots, 0);
  EXPECT_LT(SmallestSeen_m(found), 0.8 * SmallestSeen_m(assumed));
  const double both = input.in_use.covariance(0, 0) + input.session.covariance(0, 0);
  EXPECT_NEAR(Of(kRear, found).sigma(0), std::sqrt(both + 2 * 25e-8), 1e-9);
  EXPECT_THAT(AsFoundText(found, {}), ::testing::HasSubstr("held against that of 9 other robots of its rig model"));
  EXPECT_THAT(AsFoundText(assumed, {}), ::testing::HasSubstr("the policy's moved_min is taken for it"));
}

// All of its scatter along y: a pool of axes that are alike would accuse it along y and be blind along the others.
TEST(AsFound, OtherRobotsTellAlongWhichAxesASensorScatters) {
  AsFoundInput input = FirstVisit(43);
  input.pooled_scatter = PoolOfAll();
  input.pooled_scatter.at(kRear).translation.ratio = {0.04, 2.92, 0.04};
  const AsFound found = TestAsFound(input);
  const auto variance_m2 = [&](int axis) {
    return input.in_use.covariance(axis, axis) + input.session.covariance(axis, axis) +
           2 * 25e-8 * (axis == 1 ? 2.92 : 0.04);
  };
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(Of(kRear, found).sigma(axis), std::sqrt(variance_m2(axis)), 1e-9) << axis;
  EXPECT_GT(Of(kRear, found).sigma(1), 2 * Of(kRear, found).sigma(0));
}

TEST(AsFound, SensorsThatNoOtherRobotTellsKeepTheAssumedScatter) {
  AsFoundInput input = FirstVisit(42);
  const AsFound assumed = TestAsFound(input);
  input.pooled_scatter = PoolOfAll();
  input.pooled_scatter.erase(kTop);
  const AsFound found = TestAsFound(input);
  EXPECT_EQ(found.scatter_robots, 0) << "not of all of them";
  EXPECT_EQ(Of(kTop, found).sigma, Of(kTop, assumed).sigma);
  EXPECT_LT(Of(kRear, found).sigma(0), Of(kRear, assumed).sigma(0));
}

// What the calibration in use was fused by is in its covariance: it is not added once more.
TEST(AsFound, ScatterThatIsInTheCalibrationInUseCountsOnce) {
  AsFoundInput input = FirstVisit(43);
  for (KnownPose& pose : input.in_use.poses) pose.scatter_dof = ScatterDof{30.0, 30.0}, pose.scatter_robots = 6;
  const AsFound found = TestAsFound(input);
  EXPECT_EQ(found.scatter_robots, 6);
  const double both = input.in_use.covariance(0, 0) + input.session.covariance(0, 0);
  EXPECT_NEAR(Of(kRear, found).sigma(0), std::sqrt(both), 1e-9);
}

// The pool by which the first visit was fused told of the rear sensor's turns only: its shifts scatter all the same.
TEST(AsFound, ScatterOfTurnsAloneIsNoneOfShifts) {
  AsFoundInput input = FirstVisit(45);
  for (KnownPose& pose : input.in_use.poses)
    if (pose.sensor == kRear) {
      pose.visit_variance << 0, 0, 0, 4e-8, 4e-8, 4e-8;
      pose.scatter_dof = ScatterDof{0.0, 30.0};
    }
  const double shifts = input.in_use.covariance(0, 0) + input.session.covariance(0, 0),
               turns = input.in_use.covariance(3, 3) + input.session.covariance(3, 3);
  const AsFound assumed = TestAsFound(input);
  EXPECT_NEAR(Of(kRear, assumed).sigma(0), std::sqrt(shifts + 2 * std::pow(kDefaultMovedMin.m, 2)), 1e-9);
  EXPECT_NEAR(Of(kRear, assumed).sigma(3), std::sqrt(turns), 1e-9) << "in the covariance already";
  EXPECT_EQ(assumed.scatter_robots, 0);
  input.pooled_scatter = PoolOfAll();
  const AsFound found = TestAsFound(input);
  EXPECT_NEAR(Of(kRear, found).sigma(0), std::sqrt(shifts + 2 * 25e-8), 1e-9);
  EXPECT_NEAR(Of(kRear, found).sigma(3), std::sqrt(turns), 1e-9);
  EXPECT_EQ(found.scatter_robots, 9);
}

// The other way round: today's pool tells shifts only.
TEST(AsFound, APoolOfShiftsAloneLeavesTurnsToThePolicy) {
  AsFoundInput input = FirstVisit(46);
  const AsFound assumed = TestAsFound(input);
  input.pooled_scatter = PoolOfAll();
  input.pooled_scatter.at(kRear).rotation = {0.0, 1e-8, 0.0, {1.0, 1.0, 1.0}};
  const AsFound found = TestAsFound(input);
  EXPECT_LT(Of(kRear, found).sigma(0), Of(kRear, assumed).sigma(0));
  EXPECT_EQ(Of(kRear, found).sigma(3), Of(kRear, assumed).sigma(3));
  EXPECT_EQ(found.scatter_robots, 0);
}

TEST(AsFound, ItIsAsSureAsWhatVisitsScatterByIsKnown) {
  AsFoundInput input = FirstVisit(44);
  double before = std::numeric_limits<double>::infinity();
  for (const double dof : {6.0, 20.0, 200.0}) {
    for (KnownPose& pose : input.in_use.poses) pose.scatter_dof = ScatterDof{dof, dof}, pose.scatter_robots = 6;
    const double smallest_m = SmallestSeen_m(TestAsFound(input));
    EXPECT_LT(smallest_m, before) << dof;
    before = smallest_m;
  }
}

TEST(AsFound, TheSensorThatMovedIsNamedWithItsStep) {
  Vector6d step;
  step << 0.004, -0.003, 0.002, 0.003, -0.002, 0.001;
  for (const SensorId& sensor : {kRight, kRear, kTop}) {
    Draws draws(8);
    const AsFound found = TestAsFound(Visit(DrawnRig(), Bumped(DrawnRig(), sensor, step), SomeErrors(), draws));
    EXPECT_THAT(Drifted(found), ElementsAre(sensor));
    const SensorFound& named = Of(sensor, found);
    EXPECT_TRUE(named.or_else.empty());
    EXPECT_EQ(found.relative_to, kLeft);
    EXPECT_EQ(found.tests, 18);
    EXPECT_EQ(found.visits, SomeErrors().visits);
    for (int axis = 0; axis < 6; ++axis) EXPECT_NEAR(named.change(axis), step(axis), 5 * named.sigma(axis)) << axis;
    EXPECT_GT(InSigmas(named), 5);
    EXPECT_LT(named.left->norm(), 1e-9) << "updated by the session alone";
  }
}

TEST(AsFound, AReferenceThatMovedIsNamedNotAllOthers) {
  Vector6d step;
  step << -0.004, 0.003, 0.002, 0.001, 0.004, -0.003;
  Draws draws(9);
  const AsFound found = TestAsFound(Visit(DrawnRig(), Bumped(DrawnRig(), kLeft, step), SomeErrors(), draws));
  EXPECT_THAT(Drifted(found), ElementsAre(kLeft));
  EXPECT_NE(found.relative_to, kLeft);
  const SensorFound& left = Of(kLeft, found);
  for (int axis = 0; axis < 6; ++axis) EXPECT_NEAR(left.change(axis), step(axis), 5 * left.sigma(axis)) << axis;
}

TEST(AsFound, TwoThatMovedAreBothNamed) {
  Draws draws(10);
  KnownPoses is = Bumped(DrawnRig(), kRear, Along(1, 0.006));
  is = Bumped(is, kLeft, Along(4, 0.008));
  const AsFound found = TestAsFound(Visit(DrawnRig(), is, SomeErrors(), draws));
  EXPECT_THAT(Drifted(found), ElementsAre(kLeft, kRear));
}

TEST(AsFound, OfTwoSensorsEitherMayHaveMoved) {
  KnownPoses two = DrawnRig();
  two.poses.resize(2);
  Errors errors{Correlated(1.5e-4, 1e-4, 1), Correlated(3e-4, 2e-4, 1), 0, 0, 0};
  Draws draws(11);
  const AsFound found = TestAsFound(Visit(two, Bumped(two, kRear, Along(0, 0.005)), errors, draws));
  EXPECT_THAT(Drifted(found), ElementsAre(kRear));
  EXPECT_EQ(Of(kRear, found).or_else, kLeft);
}

TEST(AsFound, AnAxisThatWasNotMeasuredHasNoNumber) {
  for (const double variance : {0.0, 25.0, std::numeric_limits<double>::infinity()}) {
    Draws draws(12);
    AsFoundInput input = Visit(DrawnRig(), Bumped(DrawnRig(), kTop, Along(0, 0.005)), SomeErrors(), draws);
    const Eigen::Index open = 6 + tangent::kZ;  // of the right camera
    input.session.covariance.row(open).setZero();
    input.session.covariance.col(open).setZero();
    input.session.covariance(open, open) = variance;
    const AsFound found = TestAsFound(input);
    const SensorFound& right = Of(kRight, found);
    EXPECT_EQ(right.axes[tangent::kZ], FoundState::kNotMeasured) << variance;
    EXPECT_EQ(right.change(tangent::kZ), 0.0);
    EXPECT_EQ(right.axes[tangent::kX], FoundState::kUnchanged);
    EXPECT_EQ(right.state, FoundState::kUnchanged);
    EXPECT_EQ(found.tests, 17);
    EXPECT_THAT(Drifted(found), ElementsAre(kTop));
  }
}

// With one visit in use a scatter is assumed: it makes nothing known of an axis of which nothing was.
TEST(AsFound, AnAxisThatOneVisitDidNotMeasureHasNoNumberEither) {
  for (const int visits : {1, 1'000'000}) {
    Draws draws(16);
    Errors errors = SomeErrors();
    errors.visits = visits;
    AsFoundInput input = Visit(DrawnRig(), Bumped(DrawnRig(), kRight, Along(tangent::kZ, 0.05)), errors, draws);
    const Eigen::Index open = 6 + tangent::kZ;  // of the right camera
    input.in_use.covariance.row(open).setZero();
    input.in_use.covariance.col(open).setZero();
    const AsFound found = TestAsFound(input);
    EXPECT_EQ(Of(kRight, found).axes[tangent::kZ], FoundState::kNotMeasured) << visits;
    EXPECT_EQ(found.tests, 17) << visits;
    EXPECT_THAT(Drifted(found), ::testing::IsEmpty()) << visits;
  }
}

TEST(AsFound, WhatWasMovedOnPurposeOrIsNewIsNoDrift) {
  Draws draws(13);
  AsFoundInput input = Visit(DrawnRig(), Bumped(DrawnRig(), kTop, Along(0, 0.05)), SomeErrors(), draws);
  input.moved_on_purpose = {kTop};
  EXPECT_EQ(Of(kTop, TestAsFound(input)).state, FoundState::kMovedOnPurpose);
  EXPECT_EQ(StateOf(TestAsFound(input)), FoundState::kUnchanged);
  input.moved_on_purpose.clear();
  input.in_use.poses.pop_back();
  input.in_use.covariance = Eigen::MatrixXd(input.in_use.covariance.topLeftCorner(12, 12));
  EXPECT_EQ(Of(kTop, TestAsFound(input)).state, FoundState::kNew);
  std::swap(input.in_use, input.session);
  EXPECT_EQ(Of(kTop, TestAsFound(input)).state, FoundState::kNotMeasured);
  EXPECT_EQ(TestAsFound(input).tests, 12);
}

TEST(AsFound, WhereNothingIsToBeComparedItSaysWhy) {
  Draws draws(14);
  AsFoundInput input = Visit(DrawnRig(), DrawnRig(), SomeErrors(), draws);
  input.moved_on_purpose = {kTop, kRight, kRear};
  const AsFound found = TestAsFound(input);
  EXPECT_THAT(found.why_not, ::testing::HasSubstr("no two sensors"));
  EXPECT_EQ(StateOf(found), FoundState::kNotMeasured);
}

// Other axes, other numbers: of the right camera's frame in place of the left's, by differences.
KnownPoses ToldBy(const SensorId& reference, const KnownPoses& poses) {
  const auto seen_from = [&](const Eigen::VectorXd& errors) {
    KnownPoses moved = WithErrors(poses, errors);
    const Se3 T_ref_new = moved.Find(reference)->T_ref_sensor;
    for (KnownPose& pose : moved.poses) pose.T_ref_sensor = T_ref_new.Inverse() * pose.T_ref_sensor;
    moved.reference = reference;
    return moved;
  };
  const Eigen::Index rows = poses.covariance.rows();
  KnownPoses told = seen_from(Eigen::VectorXd::Zero(rows));
  Eigen::MatrixXd J(rows, rows);
  constexpr double kStep = 1e-6;
  for (Eigen::Index column = 0; column < rows; ++column) {
    const KnownPoses moved = seen_from(kStep * Eigen::VectorXd::Unit(rows, column));
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < told.poses.size(); ++i) {
      if (told.poses[i].sensor == reference) continue;
      J.col(column).segment<6>(row) =
          (told.poses[i].T_ref_sensor.Inverse() * moved.poses[i].T_ref_sensor).Log() / kStep;
      row += 6;
    }
  }
  told.covariance = J * poses.covariance * J.transpose();
  return told;
}

TEST(AsFound, AnotherReferenceOfTheSessionChangesNothing) {
  Draws draws(15);
  AsFoundInput input = Visit(DrawnRig(), Bumped(DrawnRig(), kTop, Along(3, 0.004)), SomeErrors(), draws);
  const AsFound found = TestAsFound(input);
  input.session = ToldBy(kRight, input.session);
  const AsFound other = TestAsFound(input);
  ASSERT_EQ(other.sensors.size(), found.sensors.size());
  EXPECT_EQ(other.relative_to, kLeft);
  for (std::size_t s = 0; s < found.sensors.size(); ++s) {
    EXPECT_EQ(other.sensors[s].axes, found.sensors[s].axes);
    EXPECT_LT((other.sensors[s].change - found.sensors[s].change).norm(), 1e-9);
    EXPECT_LT((other.sensors[s].sigma - found.sensors[s].sigma).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace rigcal::fleet
