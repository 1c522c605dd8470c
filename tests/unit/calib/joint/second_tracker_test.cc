// Trackers beside the first: each tells its poses in a world of its own, which the refinement finds.
#include "tests/bench/rig/second_tracker.h"

#include <algorithm>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

FeatureSession WithSecondTracker(std::uint64_t seed, const OtherWorld& world) {
  sim::Options options = WithSeed(seed);
  options.captures = kCaptures;
  auto experiment = sim::Prepare(WithMast(*sim::LoadRig("mars-mapper")), options);
  DrawWorldOfMast(world, *experiment);
  return RecordFeatures(*experiment, 0);
}

const Se3& PoseTold(const SessionEstimate& estimate, const SensorId& sensor) {
  return std::find_if(estimate.poses.begin(), estimate.poses.end(),
                      [&](const RefinedPose& pose) { return pose.sensor == sensor; })
      ->T_ref_sensor;
}

TEST(JointSecondTracker, ColumnsAreTheDerivativesOfTheResidual) {
  const SessionStart start = StartFrom(WithSecondTracker(50, {}));
  const SessionProblem& problem = start.problem;
  const Layout layout = LayoutOf(problem);
  const auto told = std::find_if(problem.poses.begin(), problem.poses.end(),
                                 [](const joint::PoseTold& one) { return one.board != kNone; });
  ASSERT_NE(told, problem.poses.end());
  EXPECT_EQ(problem.boards[static_cast<std::size_t>(told->board)].tracker, kMast);
  SessionState state = start.state;  // away from zero residual: the place is somewhere else
  const auto place = static_cast<std::size_t>(told->place);
  state.T_world_ref[place] =
      state.T_world_ref[place] * Se3::Exp((Vector6d() << 0.1, -0.2, 0.1, 0.3, -0.2, 0.4).finished());
  const auto residual = [&](const SessionState& at) {
    return Vector6d((T_world_body(at, *told).Inverse() * at.T_world_ref[place] *
                     at.T_ref_sensor[static_cast<std::size_t>(told->sensor)])
                        .Log());
  };
  const Observation look = Observe(problem, layout, state, *told, {0.01, 0.01}, 1.0);
  const Matrix6d J = RightJacobianInverse(residual(state));
  ASSERT_EQ(look.columns.size(), 2u);
  constexpr double kStep = 1e-6;
  std::vector<Vector6d> still(state.T_world_ref.size(), Vector6d::Zero());
  for (const Column& column : look.columns)
    for (int i = 0; i < 6; ++i) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(layout.columns, column.at + i);
      const Vector6d by_difference = (residual(Moved(problem, layout, state, step, still)) -
                                      residual(Moved(problem, layout, state, -step, still))) /
                                     (2 * kStep);
      EXPECT_LT((J * column.by.col(i) - by_difference).norm(), 1e-7) << column.at << " " << i;
    }
}

TEST(JointSecondTracker, IsRefinedWithTheRest) {
  const FeatureSession session = WithSecondTracker(51, {});
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_EQ(estimate.poses.size(), session.header.sensors.size());
  EXPECT_LT(WorstT2(session, estimate), 40.0);  // 6 are expected
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_TRUE(estimate.boards_moved.empty());
}

// The body sits where it sat: not the sensor is accused, and its pose is told as before.
TEST(JointSecondTracker, WhoseOriginJumpsIsToldByItsWorld) {
  const FeatureSession session = WithSecondTracker(52, {{0.02, 0.02}, {}});
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_TRUE(estimate.moved.empty());
  ASSERT_EQ(estimate.boards_moved.size(), 1u);
  EXPECT_EQ(estimate.boards_moved[0].world_of, kMast);
  EXPECT_TRUE(estimate.boards_moved[0].board.empty());
  EXPECT_EQ(estimate.boards_moved[0].first_after, session.experiment.captures[kCaptures / 2]);
  EXPECT_NEAR(estimate.boards_moved[0].step.tail<3>().norm(), 0.02, 0.005);
  EXPECT_LT((PoseTold(estimate, kMast).Inverse() * session.experiment.T_ref_sensor(kMast)).p_m.norm(), 0.002);
}

// Captures that the first tracker did not tell are placed by the boards, and keep what the second says of them.
TEST(JointSecondTracker, TellsCapturesThatTheFirstMissed) {
  FeatureSession session = WithSecondTracker(53, {});
  std::vector<sim::TrackerRow>& rows = session.seen.tracker.at(SensorId("body"));
  rows.resize(rows.size() / 2);
  const SessionProblem problem = StartFrom(session).problem;
  const auto told = [&](const SensorId& tracker) {
    return std::count_if(problem.poses.begin(), problem.poses.end(), [&](const joint::PoseTold& one) {
      return problem.sensors[static_cast<std::size_t>(one.sensor)] == tracker;
    });
  };
  EXPECT_EQ(told(SensorId("body")), kCaptures / 2);
  EXPECT_EQ(told(kMast), kCaptures);
}

// Nothing tells one world from a single pose: it takes no part, and the others are refined all the same.
TEST(JointSecondTracker, OfOnePoseDoesNotSpoilTheRest) {
  FeatureSession session = WithSecondTracker(54, {});
  session.seen.tracker.at(kMast).resize(1);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_EQ(estimate.poses.size(), session.header.sensors.size() - 1);
  EXPECT_TRUE(std::none_of(estimate.poses.begin(), estimate.poses.end(),
                           [](const RefinedPose& pose) { return pose.sensor == kMast; }));
}

// Captures in which nobody saw a board are placed by it where the first tracker missed them.
TEST(JointSecondTracker, PlacesCapturesWithoutBoards) {
  FeatureSession session = WithSecondTracker(55, {});
  const CaptureId last = session.experiment.captures.back();
  for (auto& [camera, views] : session.seen.views) views.at(last).found = false;
  session.seen.tracker.at(SensorId("body")).pop_back();
  const SessionProblem problem = StartFrom(session).problem;
  EXPECT_EQ(problem.captures[static_cast<std::size_t>(problem.capture_of_place.back())], last);
}

// As odometry that is set to zero: for its last captures, in which the body hardly turns, either may be.
TEST(JointSecondTracker, ThatHardlyTurnsAfterwardsMayHaveBeenMovedOrNot) {
  FeatureSession session = WithSecondTracker(56, {});
  std::vector<sim::TrackerRow>& rows = session.seen.tracker.at(kMast);
  const Se3 step = Se3::Exp((Vector6d() << 0.01, -0.02, 0.01, 0.0, 0.0, 0.0).finished());
  for (std::size_t k = rows.size() - 3; k < rows.size(); ++k) rows[k].T_world_body = step * rows[k].T_world_body;
  const SessionEstimate estimate = EstimateFrom(session);
  const bool is_body = !estimate.moved.empty() && estimate.moved[0].sensor == kMast;
  const bool is_world = !estimate.boards_moved.empty() && estimate.boards_moved[0].world_of == kMast;
  EXPECT_NE(is_body, is_world);
  EXPECT_TRUE(is_world || estimate.moved.empty() || estimate.moved[0].or_world_of == kMast);  // never the body alone
}

}  // namespace
}  // namespace rigcal::calib::joint
