// What sensors sat elsewhere by between visits that no mount need have moved by.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::graph {
namespace {

constexpr double kTolerance = 0.005;  // m and rad, as policies have it unless told otherwise

// Of each visit, by how much `sensor` is aside; the oldest first.
FusedSessions FusedOf(std::size_t sensor, const std::vector<double>& aside_m, double sigma_m, unsigned seed) {
  Random random(seed);
  Robot robot;
  for (std::size_t k = 0; k < aside_m.size(); ++k) {
    std::vector<Se3> places = Truth();
    const Se3 step = Se3::Exp((Vector6d() << 0, aside_m[k], 0, 0, 0, 0).finished());
    if (sensor == 0)
      for (std::size_t s = 1; s < 3; ++s) places[s] = step.Inverse() * places[s];
    else
      places[sensor] = places[sensor] * step;
    robot.Add(Drawn(static_cast<int>(k), places, CovarianceOf(sigma_m, sigma_m), random));
  }
  std::reverse(robot.estimates.begin(), robot.estimates.end());
  return robot.Fused().fused;
}

TEST(Apart, OfTwoVisitsWhatAMountMayExplainIsTold) {
  for (const std::size_t sensor : {0U, 1U, 2U}) {
    const FusedSessions fused = FusedOf(sensor, {0.0, 0.004}, 1e-4, 12);
    EXPECT_TRUE(fused.moved.empty()) << "a mount may give by so much";
    ASSERT_EQ(fused.apart.size(), 1U);
    EXPECT_EQ(fused.apart.front().sensor, kSensors[sensor]);
    EXPECT_EQ(fused.apart.front().last_before, SessionNamed(0));
    EXPECT_EQ(fused.apart.front().first_after, SessionNamed(1));
    EXPECT_NEAR(fused.apart.front().step.head<3>().norm(), 0.004, 4e-4);
  }
}

TEST(Apart, WhatMovedIsNotToldAgain) {
  const FusedSessions fused = FusedOf(1, {0.0, 0.02}, 1e-4, 13);
  EXPECT_EQ(fused.moved.size(), 1U);
  EXPECT_TRUE(fused.apart.empty());
}

TEST(Apart, WhatTheVisitsErrByIsNotTold) {
  EXPECT_TRUE(FusedOf(1, {0.0, 0.004}, 2e-3, 14).apart.empty());
  for (unsigned seed = 0; seed < 100; ++seed)
    EXPECT_TRUE(FusedOf(1, std::vector<double>(2 + seed % 7, 0.0), 1e-3, seed).apart.empty()) << seed;
}

// Of three visits the scatter that they show explains all of it.
TEST(Apart, AVisitBeforeTheNewestCountsToo) {
  const FusedSessions fused = FusedOf(1, {0.0, 0.006, 0.0}, 1e-4, 15);
  EXPECT_TRUE(fused.moved.empty());
  ASSERT_EQ(fused.apart.size(), 1U);
  EXPECT_EQ(fused.apart.front().last_before, SessionNamed(1));
  EXPECT_EQ(fused.apart.front().first_after, SessionNamed(2));
}

// A newest session that does not tell of the sensor hides nothing.
TEST(Apart, TheNewestSessionThatTellsOfASensorCounts) {
  Random random(16);
  Robot robot;
  std::vector<Se3> aside = Truth();
  aside[1] = aside[1] * Se3::Exp((Vector6d() << 0, 0.004, 0, 0, 0, 0).finished());
  const Eigen::MatrixXd C = CovarianceOf(1e-4, 1e-4);
  SessionEstimate without = Drawn(2, Truth(), C, random);
  robot.edges = {GoodEdge(without.session, 0, 2, without.poses[2].T_ref_sensor, 0.01, 0.01)};
  std::erase_if(without.poses, [](const RefinedPose& pose) { return pose.sensor == kLeft; });
  without.covariance = Eigen::MatrixXd(C.bottomRightCorner(6, 6));
  robot.estimates = {without};
  robot.Add(Drawn(1, aside, C, random));
  robot.Add(Drawn(0, Truth(), C, random));
  const FusedSessions fused = robot.Fused().fused;
  ASSERT_EQ(fused.apart.size(), 1U);
  EXPECT_EQ(fused.apart.front().sensor, kLeft);
  EXPECT_EQ(fused.apart.front().last_before, SessionNamed(0));
  EXPECT_EQ(fused.apart.front().first_after, SessionNamed(1));
}

int BeyondTheTolerance(int robots, int visits_max, double scatter,
                       const Eigen::MatrixXd& C = CovarianceOf(2e-4, 1.5e-4)) {
  Random random(17);
  int beyond = 0;
  for (int robot = 0; robot < robots; ++robot) {
    const int visits = 2 + robot % (visits_max - 1);
    const FusedSessions fused = Visits(visits, Truth(), scatter, scatter, C, random).Fused().fused;
    beyond += std::any_of(fused.apart.begin(), fused.apart.end(), [](const SensorMovedBetween& one) {
      return one.step.head<3>().norm() > kTolerance || one.step.tail<3>().norm() > kTolerance;
    });
  }
  return beyond;
}

// By all that a sound mount may scatter by along every axis, and by less over many visits.
TEST(Apart, SoundMountsStayWithinTheTolerance) {
  EXPECT_LE(BeyondTheTolerance(400, 2, 7.5e-4), 4);
  EXPECT_EQ(BeyondTheTolerance(200, 8, 5e-4), 0);
}

// What the others scatter by is beyond chance; the one that is known worst is not told for its own error.
TEST(Apart, AWeakSensorIsNotToldForWhatTheOthersScatterBy) {
  Eigen::MatrixXd C = CovarianceOf(1.5e-4, 1.5e-4);
  C(6, 6) = 2.5e-3 * 2.5e-3;
  EXPECT_LE(BeyondTheTolerance(400, 2, 7.5e-4, C), 4);
}

}  // namespace
}  // namespace rigcal::graph
