// What is told of sensors and boards that were moved during a session.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "server/calib/joint/misfit/moved_pose.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

class JointBumpedSensor : public testing::TestWithParam<std::tuple<const char*, double, double>> {};

TEST_P(JointBumpedSensor, IsNamedWithItsCapture) {
  const auto [name, move_m, turn_rad] = GetParam();
  sim::Options options = WithSeed(8);
  options.bump = SensorId(name);
  options.bump_m = move_m;
  options.bump_rad = turn_rad;
  const SessionStart start = StartFrom(Visit(options));
  const Refined refined = RefinedFrom(start);
  const std::vector<Move> moves = ScanForMoves(start.problem, refined);
  ASSERT_FALSE(moves.empty());
  ASSERT_NE(moves[0].sensor, kNone) << "a board: "
                                    << start.problem.boards[static_cast<std::size_t>(moves[0].board)].board.str();
  EXPECT_EQ(start.problem.sensors[static_cast<std::size_t>(moves[0].sensor)].str(), name);
  EXPECT_NEAR(moves[0].group, kCaptures / 2, 1);
  EXPECT_LT(moves[0].odds, 1e-6);
  EXPECT_NEAR(moves[0].step.head<3>().norm(), move_m, 0.5 * move_m);
}

INSTANTIATE_TEST_SUITE_P(Sizes, JointBumpedSensor,
                         testing::Values(std::tuple("front_right", 0.02, 0.035), std::tuple("back", 0.005, 0.0087),
                                         std::tuple("front_left", 0.005, 0.0087),  // the reference
                                         std::tuple("lidar_vertical", 0.02, 0.035)));

class JointRefocusedLens : public testing::TestWithParam<std::tuple<const char*, double, sim::IntrinsicsKind>> {};

// Before boards at nearly one distance a longer focal length looks like a camera that moved nearer to them.
TEST_P(JointRefocusedLens, IsNoMoveOfItsCamera) {
  const auto [name, by_ratio, intrinsics] = GetParam();
  sim::Options options = WithSeed(9);
  options.intrinsics = intrinsics;
  options.disturb.refocus = sim::Refocus{by_ratio, 0.5, SensorId(name)};
  const FeatureSession session = Visit(options);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), name);
  ASSERT_TRUE(estimate.moved[0].lens);
  EXPECT_TRUE(estimate.moved[0].lens->surely);
  EXPECT_NEAR(estimate.moved[0].lens->focal_ratio, by_ratio, 4 * estimate.moved[0].lens->sigma_ratio);
  EXPECT_LT(estimate.moved[0].lens->sigma_ratio, 0.3 * std::abs(by_ratio));
  EXPECT_LT(WorstT2(session, estimate), 40.0);  // 6 are expected
}

INSTANTIATE_TEST_SUITE_P(Lenses, JointRefocusedLens,
                         testing::Values(std::tuple("back", 0.003, sim::IntrinsicsKind::kCalibrated),
                                         std::tuple("front_right", -0.002, sim::IntrinsicsKind::kExact),
                                         std::tuple("left_front", 0.005, sim::IntrinsicsKind::kAbsent),
                                         std::tuple("front_left", 0.003,
                                                    sim::IntrinsicsKind::kCalibrated)));  // the reference

TEST(JointMoves, ABumpIsNoChangeOfTheLens) {
  for (const char* name : {"front_right", "back"}) {
    sim::Options options = WithSeed(10);
    options.bump = SensorId(name);
    options.bump_m = 0.003;
    options.bump_rad = 0.003;
    const SessionEstimate estimate = EstimateFrom(Visit(options));
    ASSERT_EQ(estimate.moved.size(), 1u) << name;
    EXPECT_FALSE(estimate.moved[0].lens) << name;
  }
}

TEST(JointMoves, NoSensorIsAccusedWhereNoneMoved) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    const SessionStart start = StartFrom(Visit(WithSeed(seed)));
    const std::vector<Move> moves = ScanForMoves(start.problem, RefinedFrom(start));
    ASSERT_FALSE(moves.empty());
    EXPECT_GT(moves[0].odds, 1e-6) << "seed " << seed;
  }
}

SmallestMove SmallestMoveOf(const SessionEstimate& estimate, const std::string& sensor) {
  for (const RefinedPose& pose : estimate.poses)
    if (pose.sensor.str() == sensor && pose.smallest_move) return *pose.smallest_move;
  ADD_FAILURE() << sensor << " has no smallest move";
  return {};
}

// Told moved in a session in which it was shifted and turned so.
void ExpectToldMoved(sim::Options options, const char* sensor, double shift_m, double turn_rad) {
  options.bump = SensorId(sensor);
  options.bump_m = shift_m;
  options.bump_rad = turn_rad;
  const SessionEstimate bumped = EstimateFrom(Visit(options));
  ASSERT_EQ(bumped.moved.size(), 1u) << sensor << ", seed " << options.seed << ": " << shift_m << " m, " << turn_rad
                                     << " rad";
  EXPECT_EQ(bumped.moved[0].sensor.str(), sensor);
}

TEST(JointMoves, AMoveAsSmallAsASessionSaysItWouldTellIsTold) {
  for (const char* sensor : {"front_right", "lidar_vertical"})
    for (const std::uint64_t seed : {21, 22, 23}) {
      const sim::Options options = WithSeed(seed);
      const SmallestMove smallest = SmallestMoveOf(EstimateFrom(Visit(options)), sensor);
      EXPECT_EQ(smallest.captures, kCaptures);
      EXPECT_LT(smallest.m, 0.05);
      ExpectToldMoved(options, sensor, smallest.m, 0.0);
      ExpectToldMoved(options, sensor, 0.0, smallest.rad);
    }
}

TEST(JointMoves, TooFewCapturesTellNoMove) {
  sim::Options options = WithSeed(21);
  options.captures = 5;
  auto experiment = sim::Prepare(*sim::LoadRig("mars-mapper"), options);
  for (const RefinedPose& pose : EstimateFrom(RecordFeatures(*experiment, 0)).poses) {
    ASSERT_TRUE(pose.smallest_move);
    EXPECT_EQ(pose.smallest_move->m, kAnyMove_m) << pose.sensor.str();
    EXPECT_EQ(pose.smallest_move->rad, kAnyMove_rad);
    EXPECT_LE(pose.smallest_move->captures, 5);
  }
}

FeatureSession BumpedVisit(const char* sensor, double shift_m, double at_ratio) {
  sim::Options options = WithSeed(20);
  options.bump = SensorId(sensor);
  options.bump_m = shift_m;
  options.bump_rad = 0.0;
  options.bump_at_ratio = at_ratio;
  return Visit(options);
}

Se3 PoseIn(const SessionEstimate& estimate, const char* sensor) {
  const auto found = std::find_if(estimate.poses.begin(), estimate.poses.end(),
                                  [&](const RefinedPose& pose) { return pose.sensor.str() == sensor; });
  EXPECT_NE(found, estimate.poses.end());
  return found->T_ref_sensor;
}

double ShiftBetween_m(const Se3& T_a, const Se3& T_b) { return (T_a.Inverse() * T_b).Log().head<3>().norm(); }

TEST(JointMoves, AMoveTooSmallToTellDividesNoSession) {
  for (const char* sensor : {"right_back", "front_left"}) {  // the reference, too
    const SessionEstimate estimate = EstimateFrom(BumpedVisit(sensor, 0.0006, 0.5));
    EXPECT_TRUE(estimate.moved.empty()) << sensor;
    EXPECT_EQ(SmallestMoveOf(estimate, sensor).captures,
              SmallestMoveOf(EstimateFrom(Visit(WithSeed(20))), sensor).captures);
  }
}

// After the bump the lidar sees two plates: where it is along the line in which they meet is open.
TEST(JointMoves, AMoveWhoseOtherSideTellsNoWholePoseIsToldAllTheSame) {
  sim::Options options = WithSeed(25);
  options.bump = SensorId("lidar_vertical");
  options.bump_m = 0.05;
  options.bump_rad = 0.05;
  FeatureSession session = Visit(options);
  int plates = 0;
  for (auto& [capture, clouds] : session.seen.clouds.at(SensorId("lidar_vertical"))) {
    if (capture < session.experiment.captures[kCaptures / 2]) continue;
    while (!clouds.empty() && (plates >= 2 || clouds.size() > 1)) clouds.erase(std::prev(clouds.end()));
    plates += static_cast<int>(clouds.size());
  }
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor.str(), "lidar_vertical");
}

TEST(JointMoves, ASensorThatMovedTwiceHasItsLastPose) {
  FeatureSession session = BumpedVisit("back", 0.01, 1.0 / 3);
  const FeatureSession later = BumpedVisit("back", 0.03, 2.0 / 3);
  for (auto& [capture, view] : session.seen.views.at(SensorId("back")))
    if (capture >= session.experiment.captures[2 * kCaptures / 3])
      view = later.seen.views.at(SensorId("back")).at(capture);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 2u);
  const Se3 first = PoseIn(EstimateFrom(Visit(WithSeed(20))), "back");
  EXPECT_NEAR(ShiftBetween_m(first, PoseIn(estimate, "back")), 0.03, 0.002);
}

// Two cameras in front, one behind that nothing but the tracked body ties to them.
sim::Rig RigOfFour() {
  sim::Rig rig = *sim::LoadRig("mars-mapper");
  const std::set<std::string> kept = {"front_left", "front_right", "back", "body"};
  std::erase_if(rig.sensors, [&](const sim::RigSensor& sensor) { return !kept.contains(sensor.id.str()); });
  std::erase_if(rig.boards, [](const sim::RigBoard& board) {
    return board.target.id.str() != "front" && board.target.id.str() != "back";
  });
  std::erase_if(rig.skip_pairs,
                [&](const SensorPair& pair) { return !kept.contains(pair.a.str()) || !kept.contains(pair.b.str()); });
  return rig;
}

// As long as only a part of it is allowed for, it looks like moves of the body too.
TEST(JointMoves, ACameraThatMovedAndMovedBackAccusesNobodyElse) {
  sim::Options options = WithSeed(4);
  options.captures = 34;
  const auto visit = [&](double shift_m) {
    options.bump = SensorId("back");
    options.bump_m = shift_m;
    options.bump_rad = 0.0;
    options.bump_at_ratio = 0.25;
    return RecordFeatures(*sim::Prepare(RigOfFour(), options), 0);
  };
  FeatureSession session = visit(0.0);
  const FeatureSession away = visit(0.02);
  for (std::size_t capture = 12; capture < 22; ++capture) {
    const CaptureId& id = session.experiment.captures[capture];
    session.seen.views.at(SensorId("back")).at(id) = away.seen.views.at(SensorId("back")).at(id);
  }
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 2u);
  for (const SensorMovedWithin& moved : estimate.moved) {
    EXPECT_EQ(moved.sensor.str(), "back") << moved.last_before.str();
    EXPECT_NEAR(moved.step.head<3>().norm(), 0.02, 0.003) << moved.last_before.str();
  }
}

TEST(JointMoves, ABoardThatMovedIsNamedAndCostsNoPose) {
  for (const std::uint64_t seed : {17, 18, 19}) {
    sim::Options options = WithSeed(seed);
    options.disturb.board_move = sim::BoardMove{{0.005, 0.0087}, 0.5, {}};
    const FeatureSession session = Visit(options);
    const SessionEstimate estimate = EstimateFrom(session);
    EXPECT_TRUE(estimate.moved.empty()) << estimate.moved[0].sensor.str() << ", seed " << seed;
    ASSERT_EQ(estimate.boards_moved.size(), 1u) << "seed " << seed;
    EXPECT_EQ(estimate.boards_moved[0].board, session.experiment.moved_board->board);
    EXPECT_GE(estimate.boards_moved[0].first_after, session.experiment.captures[kCaptures / 2]);
    EXPECT_LT(estimate.boards_moved[0].last_before, session.experiment.captures[kCaptures / 2]);
    EXPECT_LT(WorstT2(session, estimate), 25.0) << "seed " << seed;
  }
}

}  // namespace
}  // namespace rigcal::calib::joint
