// Clocks of trackers that are off while the robot does not stop for its captures. The virtual robot's motion is
// harmonic and shares no code with the refinement.
#include <algorithm>
#include <cmath>

#include "client/sim/rig/random.h"
#include "server/calib/joint/misfit/pose_clock.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

FeatureSession Swaying(std::uint64_t seed, double late_s) {
  sim::Options options = WithSeed(seed);
  options.disturb.sway_per_s = {0.2, 0.17};
  options.disturb.pose_clock_late_s = late_s;
  return Visit(options);
}

TEST(JointClock, ColumnIsTheDerivativeOfTheResidual) {
  const SessionStart start = StartFrom(Swaying(30, 0.02));
  SessionState state = start.state;
  const Layout layout = LayoutOf(start.problem);
  ASSERT_EQ(layout.clock.size(), 1u);
  ASSERT_NE(layout.clock[0], kNone);
  constexpr double kStep_s = 1e-5;
  for (const double late_s : {-0.2, 0.0, 0.05})
    for (const PoseTold& told : start.problem.poses) {
      ASSERT_EQ(told.clock, 0);
      // Away from zero residual: the place is somewhere else.
      state.T_world_ref[static_cast<std::size_t>(told.place)] =
          start.state.T_world_ref[static_cast<std::size_t>(told.place)] *
          Se3::Exp((Vector6d() << 0.1, -0.2, 0.1, 0.3, -0.2, 0.4).finished());
      const auto residual = [&](double at_s) {
        state.clock_late_s[0] = at_s;
        return Vector6d((T_world_body(state, told).Inverse() * state.T_world_ref[static_cast<std::size_t>(told.place)] *
                         state.T_ref_sensor[static_cast<std::size_t>(told.sensor)])
                            .Log());
      };
      const Vector6d by_difference = (residual(late_s + kStep_s) - residual(late_s - kStep_s)) / (2 * kStep_s);
      const Matrix6d J = RightJacobianInverse(residual(late_s));
      const Observation look = Observe(start.problem, layout, state, told, {0.01, 0.01}, 1.0);
      const auto column = std::find_if(look.columns.begin(), look.columns.end(),
                                       [&](const Column& one) { return one.at == layout.clock[0]; });
      ASSERT_NE(column, look.columns.end());
      EXPECT_LT((J * column->by - by_difference).norm(), 1e-6 * (1 + by_difference.norm()));
    }
}

TEST(JointClock, OffsetIsFoundAndTakenOut) {
  for (const double late_s : {0.0123, -0.03}) {
    const FeatureSession session = Swaying(31, late_s);
    const SessionEstimate estimate = EstimateFrom(session);
    ASSERT_EQ(estimate.clocks.size(), 1u);
    const TrackerClock& clock = estimate.clocks[0];
    EXPECT_EQ(clock.tracker, SensorId("body"));
    EXPECT_EQ(clock.captures, kCaptures);
    EXPECT_EQ(clock.given_sigma_s, kClockSigma_s);
    EXPECT_NEAR(clock.late_s, late_s, 4 * clock.sigma_s);
    EXPECT_LT(clock.sigma_s, 0.002);
    EXPECT_TRUE(clock.IsKnown());
    EXPECT_TRUE(clock.IsOff());
    EXPECT_LT(WorstT2(session, estimate), 40.0);  // 6 are expected
  }
}

TEST(JointClock, OneThatIsFarOffIsFoundByFittingPathsAgain) {
  const SessionEstimate estimate = EstimateFrom(Swaying(32, 0.12));
  ASSERT_EQ(estimate.clocks.size(), 1u);
  EXPECT_NEAR(estimate.clocks[0].late_s, 0.12, 4 * estimate.clocks[0].sigma_s + 0.0005);
}

// Farther than any path about its captures tells.
TEST(JointClock, OneThatDoesNotSettleIsNotKnown) {
  const FeatureSession session = Swaying(32, 0.6);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.clocks.size(), 1u);
  const TrackerClock& clock = estimate.clocks[0];
  EXPECT_FALSE(clock.IsKnown());
  EXPECT_FALSE(clock.IsOff());
  EXPECT_LT(std::abs(clock.late_s - 0.6), 4 * clock.sigma_s);
  EXPECT_LT(WorstT2(session, estimate), 40.0);  // the poses are in doubt as well
}

TEST(JointClock, WhatLensesMayDoToItIsInItsSigma) {
  const SessionStart start = StartFrom(Swaying(36, 0.01));
  const auto refined = Refine(start.problem, start.state, start.noise, GroupsOf(start.problem, start.state));
  ASSERT_TRUE(refined.has_value());
  const int at = refined->layout.clock[0], size = refined->layout.size;
  ASSERT_NE(at, kNone);
  Eigen::MatrixXd lenses = Eigen::MatrixXd::Zero(size, size);
  lenses(at, at) = 1e-6;  // 1 ms
  const double without_s = ClocksTold(start.problem, *refined, 1.0, {})[0].sigma_s,
               with_s = ClocksTold(start.problem, *refined, 1.0, lenses)[0].sigma_s;
  EXPECT_NEAR(with_s * with_s - without_s * without_s, 1e-6, 1e-12);
}

TEST(JointClock, OneThatIsRightIsNotCalledOff) {
  const FeatureSession session = Swaying(33, 0.0);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.clocks.size(), 1u);
  EXPECT_TRUE(estimate.clocks[0].IsKnown());
  EXPECT_FALSE(estimate.clocks[0].IsOff());
  EXPECT_LT(WorstT2(session, estimate), 40.0);
}

TEST(JointClock, TheSigmaOfTheSessionPulls) {
  const FeatureSession session = Swaying(34, 0.0);
  SessionViews views = ViewsOf(session, NominalPoses(session));
  views.trackers[0].tracker.clock_sigma_s = 1e-6;
  const SessionEstimate pulled = EstimateSession(views);
  ASSERT_EQ(pulled.clocks.size(), 1u);
  EXPECT_LE(pulled.clocks[0].sigma_s, 1e-6);
  EXPECT_LT(std::abs(pulled.clocks[0].late_s), 4e-6);
  EXPECT_FALSE(pulled.clocks[0].IsKnown());  // no better than before
  views.trackers[0].tracker.clock_sigma_s = 0.0;
  EXPECT_TRUE(EstimateSession(views).clocks.empty());
}

// Where the body stood, as often as a path tells it, with noise.
PoseTable Standing(const PoseTable& poses) {
  sim::Random random(sim::KeyOf(35, "standing"));
  PoseTable path;
  for (const TimedPose& row : poses)
    for (int i = -25; i < 25; ++i) {
      Vector6d noise;
      noise << 2e-4 * random.Normals<3>(), 9e-4 * random.Normals<3>();
      path.push_back({{}, Stamp{row.stamp.ns + i * 10'000'000 + 3'000'000}, row.T_world_body * Se3::Exp(noise)});
    }
  return path;
}

TEST(JointClock, OfABodyThatStandsStillIsNotKnownAndChangesNothing) {
  const FeatureSession session = Visit(WithSeed(35));
  SessionViews views = ViewsOf(session, NominalPoses(session));
  ASSERT_TRUE(views.trackers[0].path.empty());
  const SessionEstimate without = EstimateSession(views);
  EXPECT_TRUE(without.clocks.empty());
  views.trackers[0].path = Standing(views.trackers[0].poses);
  const SessionEstimate with = EstimateSession(views);
  ASSERT_EQ(with.clocks.size(), 1u);
  EXPECT_EQ(with.clocks[0].captures, 0);
  EXPECT_EQ(with.clocks[0].late_s, 0.0);
  EXPECT_EQ(with.clocks[0].sigma_s, with.clocks[0].given_sigma_s);
  EXPECT_FALSE(with.clocks[0].IsKnown());
  EXPECT_FALSE(with.clocks[0].IsOff());
  ASSERT_EQ(with.poses.size(), without.poses.size());
  for (std::size_t i = 0; i < with.poses.size(); ++i)
    EXPECT_EQ(with.poses[i].T_ref_sensor, without.poses[i].T_ref_sensor) << with.poses[i].sensor.str();
  EXPECT_EQ(with.covariance, without.covariance);
}

}  // namespace
}  // namespace rigcal::calib::joint
