// Moves of which a session does not tell all: too near its end, of which of two sensors or boards, or of the reference.
#include <gmock/gmock.h>

#include <algorithm>

#include "server/calib/joint/misfit/moved_pose.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

sim::Options Bump(const char* sensor, int captures_after) {
  sim::Options options = WithSeed(31);
  options.bump = SensorId(sensor);
  options.bump_m = 0.01;
  options.bump_rad = 0.0175;
  options.bump_at_ratio = (kCaptures - captures_after + 0.5) / kCaptures;
  return options;
}

// Either found, with a capture at most one off, or in doubt.
TEST(JointAmbiguousMoves, ABumpBeforeTheLastCaptureOrTwoIsFoundOrLeavesThemInDoubt) {
  for (const char* sensor : {"front_right", "front_left", "lidar_vertical", "body"})
    for (const int after : {1, 2}) {
      const FeatureSession session = Visit(Bump(sensor, after));
      const SessionEstimate estimate = EstimateFrom(session);
      ASSERT_EQ(estimate.moved.size() + estimate.late.size(), 1u) << sensor << ", " << after;
      if (!estimate.moved.empty()) {
        EXPECT_EQ(estimate.moved[0].sensor.str(), sensor);
        EXPECT_GE(estimate.moved[0].first_after, session.experiment.captures[kCaptures - 3]);
        continue;
      }
      EXPECT_EQ(estimate.late[0].sensor.str(), sensor);
      EXPECT_EQ(estimate.late[0].captures, after) << sensor;
      EXPECT_TRUE(estimate.late[0].or_board.empty()) << sensor << ": others saw where its board is";
      EXPECT_EQ(estimate.late[0].first, session.experiment.captures[static_cast<std::size_t>(kCaptures - after)]);
    }
}

TEST(JointAmbiguousMoves, NothingIsInDoubtWhereNothingMoved) {
  for (const std::uint64_t seed : {31, 32, 33, 34})
    EXPECT_TRUE(EstimateFrom(Visit(WithSeed(seed))).late.empty()) << seed;
}

TEST(JointAmbiguousMoves, ALookThatIsFollowedByOthersThatFitLeavesNoDoubt) {
  FeatureSession session = Visit(WithSeed(31));
  const FeatureSession moved = Visit(Bump("front_right", kCaptures - 1));
  const CaptureId& one = session.experiment.captures[kCaptures - 2];
  session.seen.views.at(SensorId("front_right")).at(one) = moved.seen.views.at(SensorId("front_right")).at(one);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.held_back.size(), 1u);
  EXPECT_EQ(estimate.held_back[0].capture, one);
  EXPECT_TRUE(estimate.late.empty());
}

// One cloud shows several boards: that is no run of captures.
TEST(JointAmbiguousMoves, OneCloudThatContradictsAllOthersIsHeldBack) {
  FeatureSession session = Visit(WithSeed(31));
  sim::Options far = Bump("lidar_vertical", kCaptures - 1);
  far.bump_m = far.bump_rad = 0.1;
  const FeatureSession moved = Visit(far);
  const CaptureId& one = session.experiment.captures[kCaptures / 2];
  const SensorId lidar("lidar_vertical");
  session.seen.clouds.at(lidar).at(one) = moved.seen.clouds.at(lidar).at(one);
  ASSERT_GE(session.seen.clouds.at(lidar).at(one).size(), 3u);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_TRUE(estimate.moved.empty());
  ASSERT_FALSE(estimate.held_back.empty());
  for (const HeldBackLook& look : estimate.held_back)
    EXPECT_EQ(look.sensor.str() + look.capture.str(), lidar.str() + one.str());
}

TEST(JointAmbiguousMoves, ABumpBeforeTheLastBurstIsFound) {
  sim::Options options = WithSeed(32);
  options.bump = SensorId("left_front");
  options.bump_m = 0.01;
  options.bump_rad = 0.0175;
  options.captures = 32;
  options.bump_at_ratio = 28.5 / 32;
  options.disturb.burst = 4;
  auto experiment = sim::Prepare(*sim::LoadRig("mars-mapper"), options);
  const SessionEstimate estimate = EstimateFrom(RecordFeatures(*experiment, 0));
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "left_front");
  EXPECT_EQ(estimate.moved[0].first_after, experiment->captures[28]);
}

// 60 captures in 40 groups: which capture of two groups it was before is not known.
TEST(JointAmbiguousMoves, WhereGroupsHoldSeveralCapturesTheToldOnesEncloseTheBump) {
  sim::Options options = Bump("left_front", kCaptures / 2);
  options.captures = 60;
  for (const double at_capture : {31.5, 32.5}) {
    options.bump_at_ratio = at_capture / 60;
    auto experiment = sim::Prepare(*sim::LoadRig("mars-mapper"), options);
    const SessionEstimate estimate = EstimateFrom(RecordFeatures(*experiment, 0));
    ASSERT_EQ(estimate.moved.size(), 1u);
    const CaptureId &before = experiment->captures[experiment->bumped_from_idx - 1],
                    &after = experiment->captures[experiment->bumped_from_idx];
    EXPECT_LE(estimate.moved[0].last_before, before);
    EXPECT_GE(estimate.moved[0].first_after, after);
    EXPECT_LT(estimate.moved[0].last_before, estimate.moved[0].first_after);
    EXPECT_TRUE(estimate.late.empty());
  }
}

TEST(JointAmbiguousMoves, PosesAreToldAgainstTheReferenceWhereItEndedUp) {
  const FeatureSession session = Visit(Bump("front_left", kCaptures / 2));
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "front_left");
  const Se3 T_body_ref = session.experiment.T_body_sensor(SensorId("front_left"), kCaptures - 1);
  for (std::size_t i = 0; i < estimate.poses.size(); ++i) {
    const int row = RowOf(estimate, i);
    if (row < 0) continue;
    const Se3 T_ref_sensor =
        T_body_ref.Inverse() * session.experiment.T_body_sensor(estimate.poses[i].sensor, kCaptures - 1);
    const Vector6d error = (estimate.poses[i].T_ref_sensor.Inverse() * T_ref_sensor).Log();
    const Matrix6d C = estimate.covariance.block<6, 6>(row, row);
    EXPECT_LT(error.dot(C.ldlt().solve(error)), 25.0) << estimate.poses[i].sensor.str();
  }
}

FeatureSession VisitOf(sim::Rig rig, sim::Options options) {
  options.captures = kCaptures;
  rig.skip_pairs.clear();
  return RecordFeatures(*sim::Prepare(std::move(rig), options), 0);
}

TEST(JointAmbiguousMoves, OfTwoSensorsBothAreNamed) {
  sim::Rig rig = *sim::LoadRig("mars-mapper");
  std::erase_if(rig.sensors, [](const sim::RigSensor& one) { return one.sees != TargetId("front"); });
  std::erase_if(rig.boards, [](const sim::RigBoard& one) { return one.target.id != TargetId("front"); });
  for (const char* sensor : {"front_left", "front_right"}) {
    const SessionEstimate estimate = EstimateFrom(VisitOf(rig, Bump(sensor, kCaptures / 2)));
    ASSERT_EQ(estimate.moved.size(), 1u) << sensor;
    EXPECT_EQ(estimate.moved[0].sensor.str(), "front_right") << "whose pose is told, bumped " << sensor;
    EXPECT_EQ(estimate.moved[0].or_sensor.str(), "front_left") << "the reference, bumped " << sensor;
  }
}

TEST(JointAmbiguousMoves, OfManySensorsThatTellWhichThereIsNoOther) {
  const SessionEstimate estimate = EstimateFrom(Visit(Bump("front_right", kCaptures / 2)));
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_TRUE(estimate.moved[0].or_sensor.empty());
  EXPECT_TRUE(estimate.moved[0].or_board.empty());
}

// Nobody tells the world but the boards, whose most seen one is its frame.
TEST(JointAmbiguousMoves, WithoutATrackerTheBoardThatIsTheWorldMayMove) {
  sim::Rig rig = *sim::LoadRig("mars-mapper");
  std::erase_if(rig.sensors, [](const sim::RigSensor& one) { return one.kind == SensorKind::kTracker; });
  const FeatureSession still = VisitOf(rig, WithSeed(33));
  const SessionProblem problem = StartFrom(still).problem;
  ASSERT_NE(problem.held_board, kNone);
  const TargetId held = problem.boards[static_cast<std::size_t>(problem.held_board)].board;
  sim::Options options = WithSeed(33);
  options.disturb.board_move = sim::BoardMove{{0.01, 0.0175}, 0.5, held};
  const SessionEstimate estimate = EstimateFrom(VisitOf(rig, options));
  EXPECT_TRUE(estimate.moved.empty()) << estimate.moved[0].sensor.str();
  ASSERT_EQ(estimate.boards_moved.size(), 1u);
  EXPECT_EQ(estimate.boards_moved[0].board, held);
}

}  // namespace
}  // namespace rigcal::calib::joint
