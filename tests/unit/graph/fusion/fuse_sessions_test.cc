// Session estimates are drawn here from their own covariances: what is fused must be as sure as it says.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/math/statistics.h"
#include "server/model/edges/past.h"
#include "tests/unit/graph/fusion/drawn_visits.h"

namespace rigcal::graph {
namespace {

TEST(FuseSessions, OneSessionIsTakenAsItIs) {
  Random random(1);
  const Robot robot = Visits(1, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random);
  const GraphSolution solution = robot.Fused();
  ASSERT_EQ(solution.fused.sessions, std::vector<SessionId>{SessionNamed(0)});
  for (std::size_t s = 1; s < 3; ++s) {
    const SensorPose& pose = solution.poses[s];
    ASSERT_TRUE(pose.fused);
    EXPECT_LT((pose.T_ref_sensor.Inverse() * robot.estimates[0].poses[s].T_ref_sensor).Log().norm(), 1e-9);
    EXPECT_GT((pose.fused->T_ref_sensor_by_pairs.Inverse() * pose.T_ref_sensor).Log().norm(), 1e-5);
    EXPECT_NEAR(pose.dof, 200.0, 1.0);
  }
  EXPECT_LT((solution.fused.covariance - robot.estimates[0].covariance).norm(),
            1e-6 * robot.estimates[0].covariance.norm());
}

// Estimates go from the newest on.
TEST(FuseSessions, OfATrackersClockTheNewestSessionTells) {
  Random random(11);
  Robot robot = Visits(2, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random);
  robot.estimates[0].clocks = {{SensorId("body"), 0.01, 0.001, 0.05, 20}};
  robot.estimates[1].clocks = {{SensorId("body"), 0.02, 0.001, 0.05, 20}, {SensorId("arm"), 0.0, 0.05, 0.05, 0}};
  const auto clocks = robot.Fused().fused.clocks;
  ASSERT_EQ(clocks.size(), 2u);
  EXPECT_EQ(clocks[0].clock.tracker, SensorId("arm"));
  EXPECT_EQ(clocks[0].session, robot.estimates[1].session);
  EXPECT_EQ(clocks[1].clock.tracker, SensorId("body"));
  EXPECT_EQ(clocks[1].clock.late_s, 0.01);
  EXPECT_EQ(clocks[1].session, robot.estimates[0].session);
}

TEST(FuseSessions, TheCapturesThatDoMostAreOfTheNewestSession) {
  Random random(12);
  Robot robot = Visits(2, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random);
  EXPECT_FALSE(robot.Fused().fused.influential);
  const SensorId one = robot.estimates[0].poses[1].sensor, other = robot.estimates[0].poses[2].sensor, gone("gone");
  robot.estimates[0].groups = {
      {{CaptureId("1")}, one, 0.5}, {{CaptureId("2"), CaptureId("3")}, other, 1.5}, {{CaptureId("5")}, gone, 9.0}};
  robot.estimates[1].groups = {{{CaptureId("4")}, one, 7.0}};
  const auto most = robot.Fused().fused.influential;
  ASSERT_TRUE(most);
  EXPECT_EQ(most->session, robot.estimates[0].session);
  EXPECT_EQ(most->captures, (std::vector{CaptureId("2"), CaptureId("3")}));
  EXPECT_EQ(most->sensor, other);
  EXPECT_EQ(most->sigmas, 1.5);
}

TEST(FuseSessions, PushedEdgeCountsByItsInformationAndAnEdgeOfTheSessionDoesNotCountTwice) {
  Random random(2);
  Robot robot = Visits(1, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random);
  robot.edges.push_back(GoodEdge({}, 0, 1, robot.estimates[0].poses[1].T_ref_sensor, 3e-4, 2e-4));
  const GraphSolution solution = robot.Fused();
  EXPECT_NEAR(solution.fused.covariance(0, 0), 0.5 * 9e-8, 1e-10);
  EXPECT_NEAR(solution.fused.covariance(3, 3), 0.5 * 4e-8, 1e-10);
}

TEST(FuseSessions, AgreeingVisitsNarrowThePose) {
  Random random(3);
  const GraphSolution solution = Visits(4, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random).Fused();
  const FusedPose& fused = *solution.poses[1].fused;
  EXPECT_EQ(fused.sessions, 4);
  EXPECT_LT(fused.visit_sigma_m, 3e-4);
  EXPECT_NEAR(solution.poses[1].covariance(0, 0), std::pow(3e-4, 2) / 4 + std::pow(fused.visit_sigma_m, 2), 3e-8);
}

TEST(FuseSessions, WhatErrsAlikeOnEveryVisitDoesNotFallWithTheirNumber) {
  Random random(4);
  Robot robot;
  const Eigen::MatrixXd own = CovarianceOf(1e-5, 1e-5), common = CovarianceOf(3e-4, 2e-4);
  const Eigen::VectorXd shared = random.Of(common);
  for (int k = 0; k < 4; ++k) {
    std::vector<Se3> seen = Truth();
    seen[1] = seen[1] * Se3::Exp(shared.head<6>());
    seen[2] = seen[2] * Se3::Exp(shared.tail<6>());
    SessionEstimate estimate = Drawn(k, seen, own, random);
    estimate.covariance += common;
    estimate.common = common;
    robot.Add(estimate);
  }
  const GraphSolution solution = robot.Fused();
  EXPECT_NEAR(std::sqrt(solution.poses[1].covariance(0, 0)), 3e-4, 2e-5);
  EXPECT_NEAR(std::sqrt(solution.poses[2].covariance(4, 4)), 2e-4, 2e-5);
}

// A sensor that sits a little elsewhere on each visit: where it sits on the next lies in the region told.
TEST(FuseSessions, NextVisitLiesInTheRegionTold) {
  constexpr double kScatter_m = 3e-4, kScatter_rad = 1.7e-4;
  Random random(5);
  int inside = 0, asked = 0;
  for (int robot = 0; robot < 150; ++robot) {
    const GraphSolution solution =
        Visits(10, Truth(), kScatter_m, kScatter_rad, CovarianceOf(1e-4, 1e-4), random).Fused();
    const std::vector<Se3> next = Scattered(Truth(), kScatter_m, kScatter_rad, random);
    for (std::size_t s = 1; s < 3; ++s, ++asked) {
      const SensorPose& pose = solution.poses[s];
      const Vector6d e = (pose.T_ref_sensor.Inverse() * next[s]).Log();
      const double limit = HotellingLimit(static_cast<int>(pose.dof) + 1);
      inside += e.dot(pose.covariance.ldlt().solve(e)) <= limit ? 1 : 0;
    }
  }
  EXPECT_GE(inside, asked * 91 / 100);
  EXPECT_LE(inside, asked * 98 / 100);
}

// A lens that is given errs alike on every visit, by as much as the sensor scatters: the one hides none of the other.
TEST(FuseSessions, NextVisitLiesInTheRegionToldWhereVisitsErrAlike) {
  constexpr double kScatter_m = 3e-4, kScatter_rad = 2e-4;
  const Eigen::MatrixXd own = CovarianceOf(5e-5, 5e-5), common = CovarianceOf(kScatter_m, kScatter_rad);
  Random random(15);
  int inside = 0, asked = 0;
  for (int k = 0; k < 150; ++k) {
    Robot robot;
    const Eigen::VectorXd shared = random.Of(common);
    for (int visit = 0; visit < 10; ++visit) {
      std::vector<Se3> seen = Scattered(Truth(), kScatter_m, kScatter_rad, random);
      seen[1] = seen[1] * Se3::Exp(shared.head<6>());
      seen[2] = seen[2] * Se3::Exp(shared.tail<6>());
      SessionEstimate estimate = Drawn(visit, seen, own, random);
      estimate.covariance += common;
      estimate.common = common;
      robot.Add(estimate);
    }
    const GraphSolution solution = robot.Fused();
    const std::vector<Se3> next = Scattered(Truth(), kScatter_m, kScatter_rad, random);
    for (std::size_t s = 1; s < 3; ++s, ++asked) {
      const SensorPose& pose = solution.poses[s];
      const Vector6d e = (pose.T_ref_sensor.Inverse() * next[s]).Log();
      inside += e.dot(pose.covariance.ldlt().solve(e)) <= HotellingLimit(static_cast<int>(pose.dof) + 1) ? 1 : 0;
    }
  }
  EXPECT_GE(inside, asked * 91 / 100);
  EXPECT_LE(inside, asked * 98 / 100);
}

TEST(FuseSessions, TwoVisitsThatDisagreeAreNotAveragedIntoCertainty) {
  Random random(6);
  Robot robot;
  robot.Add(Drawn(0, Truth(), CovarianceOf(1e-4, 1e-4), random));
  std::vector<Se3> elsewhere = Truth();
  elsewhere[1] = elsewhere[1] * Se3::Exp((Vector6d() << 0.01, 0, 0, 0, 0, 0).finished());
  robot.Add(Drawn(1, elsewhere, CovarianceOf(1e-4, 1e-4), random));
  const GraphSolution solution = robot.Fused();
  EXPECT_GT(solution.poses[1].fused->visit_sigma_m, 2e-3);
  EXPECT_GT(std::sqrt(solution.poses[1].covariance(0, 0)), 2e-3);
  EXPECT_LT(std::sqrt(solution.poses[2].covariance(0, 0)),
            1e-3);  // of two visits a little of the other's is taken for it
}

// 2 mm and 1 mrad, as sure as 60 numbers are.
const PooledScatter kPooledLeft = {{kLeft, {{4e-6, 9e-8, 60.0}, {1e-6, 4e-8, 60.0}, 7}}};

// Of one visit nothing tells how it scatters: where the sensor is on the next visit, both visits' scatter is in it.
TEST(FuseSessions, OneVisitScattersAsThoseOfOtherRobotsDo) {
  Random random(21);
  const GraphSolution solution = Visits(1, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random).Fused(kPooledLeft);
  const SensorPose &left = solution.poses[1], &right = solution.poses[2];
  EXPECT_NEAR(left.fused->visit_sigma_m, 2e-3, 1e-9);
  EXPECT_NEAR(left.fused->visit_sigma_rad, 1e-3, 1e-9);
  EXPECT_NEAR(left.fused->scatter_dof.translation, 60.0, 1e-9);
  EXPECT_EQ(left.fused->pooled_scatter->robots, 7);
  EXPECT_NEAR(left.covariance(0, 0), 9e-8 + 2 * 4e-6, 1e-8);
  EXPECT_NEAR(left.covariance(3, 3), 4e-8 + 2 * 1e-6, 1e-8);
  EXPECT_FALSE(right.fused->pooled_scatter);
  EXPECT_NEAR(right.covariance(0, 0), 9e-8, 1e-10);
}

TEST(FuseSessions, FewVisitsAreHeldAgainstThoseOfOtherRobots) {
  Random random(22);
  const Robot robot = Visits(3, Truth(), 2e-3, 1e-3, CovarianceOf(3e-4, 2e-4), random);
  const FusedPose alone = *robot.Fused().poses[1].fused, pooled = *robot.Fused(kPooledLeft).poses[1].fused;
  EXPECT_EQ(alone.scatter.translation.dof, 6.0);
  EXPECT_NEAR(alone.scatter.translation.own, 9e-8, 1e-10);
  EXPECT_NEAR(alone.visit_sigma_m, std::sqrt(alone.scatter.translation.between), 0.2 * alone.visit_sigma_m);
  EXPECT_EQ(alone.scatter_dof.translation, 3.5);  // two of each axis, 2 - 1 / 2 of both sensors on the whole
  const double mean = (6 * alone.scatter.translation.between + 60 * 4e-6) / 66;
  EXPECT_NEAR(pooled.visit_sigma_m, std::sqrt(mean), 1e-8);
  EXPECT_NEAR(pooled.scatter_dof.translation, 66.0, 1e-9);
}

// As if it hung on one screw, about z: what is told of the next visit is along the axis along which it scatters.
TEST(FuseSessions, AxesScatterAsUnlikeAsThoseOfOtherRobots) {
  Random random(26);
  PooledScatter pool = kPooledLeft;
  pool.at(kLeft).rotation.ratio = {0.05, 0.05, 2.9};
  const SensorPose left = Visits(1, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random).Fused(pool).poses[1];
  EXPECT_NEAR(left.covariance(0, 0), 9e-8 + 2 * 4e-6, 1e-8);
  EXPECT_NEAR(left.covariance(3, 3), 4e-8 + 2 * 1e-6 * 0.05, 1e-9);
  EXPECT_NEAR(left.covariance(5, 5), 4e-8 + 2 * 1e-6 * 2.9, 1e-8);
}

TEST(FuseSessions, TellsAlongWhichAxesItsVisitsScatter) {
  Random random(27);
  Robot robot;
  for (int k = 0; k < 40; ++k) {
    std::vector<Se3> places = Truth();
    places[1] = places[1] * Se3::Exp((Vector6d() << 0, 2e-3 * random.Normal(1)[0], 0, 0, 0, 0).finished());
    robot.Add(Drawn(k, places, CovarianceOf(1e-4, 1e-4), random));
  }
  const VisitScatter shown = robot.Fused().poses[1].fused->scatter;
  ASSERT_TRUE(shown.translation.TellsAxes() && shown.rotation.TellsAxes());
  EXPECT_GT(shown.translation.ratio[1], 2.5);
  EXPECT_LT(shown.translation.ratio[0], 0.1);
  EXPECT_NEAR(shown.translation.ratio[0] + shown.translation.ratio[1] + shown.translation.ratio[2], 3.0, 0.05);
  for (const double ratio : shown.rotation.ratio) EXPECT_NEAR(ratio, 1.0, 4 * std::sqrt(2.0 / 39));
}

// Of a robot alone, what is told of the next visit is along the axis along which it scatters.
TEST(FuseSessions, WithoutOtherRobotsEachAxisGoesByItself) {
  Random random(29);
  Robot robot;
  for (int k = 0; k < 12; ++k) {
    std::vector<Se3> places = Truth();
    places[1] = places[1] * Se3::Exp((Vector6d() << 0, 2e-3 * random.Normal(1)[0], 0, 0, 0, 0).finished());
    robot.Add(Drawn(k, places, CovarianceOf(1e-4, 1e-4), random));
  }
  const SensorPose left = robot.Fused().poses[1];
  EXPECT_EQ(left.fused->scatter_dof.translation, 12.5);
  ASSERT_TRUE(left.fused->visit_variance);
  EXPECT_GT(left.covariance(1, 1), 10 * left.covariance(0, 0));
  EXPECT_GT(left.covariance(1, 1), 1e-6);
  EXPECT_NEAR(left.covariance(1, 1), (*left.fused->visit_variance)(1) * 13 / 12, 0.1 * left.covariance(1, 1));
}

// What others learn from is what the robot's own visits tell, to the last bit.
TEST(FuseSessions, WhatItsOwnVisitsTellIsTheSameWhateverOtherRobotsDo) {
  Random random(23);
  const Robot robot = Visits(5, Truth(), 5e-4, 3e-4, CovarianceOf(3e-4, 2e-4), random);
  const GraphSolution alone = robot.Fused(), pooled = robot.Fused(kPooledLeft);
  for (std::size_t s = 1; s < 3; ++s) EXPECT_EQ(alone.poses[s].fused->scatter, pooled.poses[s].fused->scatter);
  EXPECT_GT(pooled.poses[1].fused->visit_sigma_m, 1.5 * alone.poses[1].fused->visit_sigma_m);
}

// Visits without any scatter: what they show beyond their own errors is as often below zero as above.
TEST(FuseSessions, ScatterThatIsShownIsRightOnAverage) {
  Random random(24);
  double sum = 0.0;
  int below = 0;
  constexpr int kRobots = 150;
  for (int robot = 0; robot < kRobots; ++robot) {
    const FusedPose fused = *Visits(6, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random).Fused().poses[1].fused;
    sum += fused.scatter.translation.between;
    below += fused.scatter.translation.between < 0 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kRobots, 0.0, 6 * 9e-8 * std::sqrt(2.0 / 15 / kRobots));
  EXPECT_GT(below, kRobots / 3);
  EXPECT_LT(below, kRobots * 4 / 5);
}

// What is left of a session whose reference was remounted are the poses among its other sensors.
TEST(FuseSessions, SessionOfARemountedReferenceStillTellsTheRest) {
  Random random(7);
  Robot robot;
  const Eigen::MatrixXd C = CovarianceOf(3e-4, 2e-4);
  std::vector<Se3> before = Truth();
  const Se3 moved = Pose(0.03, 0.1);
  for (std::size_t s = 1; s < 3; ++s) before[s] = moved * before[s];
  robot.Add(Drawn(0, before, C, random));
  for (Edge& edge : robot.edges)
    if (edge.frame_a == kBase)
      edge.state = EdgeState::kFailed, edge.diagnoses = {{std::string(kRemountedCode), "", ""}};
  robot.Add(Drawn(1, Truth(), C, random));
  const GraphSolution both = robot.Fused();
  Robot newer;
  newer.Add(robot.estimates[1]);
  const GraphSolution alone = newer.Fused();
  ASSERT_EQ(both.fused.sessions.size(), 2u);
  const auto between = [&](const GraphSolution& solution) {
    const auto& J = solution.fused.covariance;
    const Se3 T = solution.poses[1].T_ref_sensor.Inverse() * solution.poses[2].T_ref_sensor;
    return RelativeCovariance(T, J.block<6, 6>(0, 0), J.block<6, 6>(6, 6), J.block<6, 6>(0, 6));
  };
  EXPECT_LT(between(both).trace(), 0.8 * between(alone).trace());
  for (std::size_t s = 1; s < 3; ++s)
    EXPECT_LT((both.poses[s].T_ref_sensor.Inverse() * Truth()[s]).Log().norm(), 0.003);
}

LensMisfit BentBy(const SensorId& camera, double rms_px) {
  LensMisfit misfit;
  misfit.camera = camera;
  misfit.rms_px = rms_px;
  return misfit;
}

// The first estimate is the newest.
TEST(FuseSessions, LensesThatBendAreThoseOfTheNewestSession) {
  Random random(9);
  Robot robot = Visits(2, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random);
  robot.estimates[0].misfits = {BentBy(kRight, 0.1)};
  robot.estimates[1].misfits = {BentBy(kLeft, 0.2), BentBy(kRight, 0.3)};
  const std::vector<LensMisfit> lenses = robot.Fused().fused.lenses;
  ASSERT_EQ(lenses.size(), 1u) << "left took part in the newest and does not bend there";
  EXPECT_EQ(lenses[0].camera, kRight);
  EXPECT_EQ(lenses[0].rms_px, 0.1);
}

TEST(FuseSessions, SessionWithARetiredEdgeIsNotFused) {
  Random random(8);
  Robot robot = Visits(1, Truth(), 0, 0, CovarianceOf(3e-4, 2e-4), random);
  robot.edges[2].state = EdgeState::kFailed;
  robot.edges[2].diagnoses = {{std::string(kRetiredCode), "", ""}};
  const GraphSolution solution = robot.Fused();
  EXPECT_TRUE(solution.fused.sessions.empty());
  EXPECT_FALSE(solution.poses[1].fused);
}

}  // namespace
}  // namespace rigcal::graph
