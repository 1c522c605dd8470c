// The joint refinement against a virtual robot that shares none of its mathematics: corners are projected by OpenCV.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "client/sim/rig_yaml.h"
#include "server/calib/joint/cluster_covariance.h"
#include "server/calib/joint/estimate_session.h"
#include "server/calib/joint/moved_pose.h"
#include "tests/bench/joint_session.h"

namespace rigcal::calib::joint {
namespace {

constexpr int kCaptures = 12;

sim::Options WithSeed(std::uint64_t seed) {
  sim::Options options;
  options.seed = seed;
  return options;
}

FeatureSession Visit(sim::Options options) {
  options.captures = kCaptures;
  auto experiment = sim::Prepare(*sim::LoadRig("mars-mapper"), options);
  return RecordFeatures(*experiment, 0);
}

SessionStart StartFrom(const FeatureSession& session) {
  auto start = StartOf(ViewsOf(session, NominalPoses(session)));
  EXPECT_TRUE(start) << Sentence(start.error());
  return std::move(start).value();
}

Refined RefinedFrom(const SessionStart& start) {
  auto refined = Refine(start.problem, start.state, start.noise, GroupsOf(start.problem, start.state));
  EXPECT_TRUE(refined) << Sentence(refined.error());
  return std::move(refined).value();
}

struct Fixed {
  SessionStart start;
  Layout layout;
  LookWeights weights;
  std::vector<int> groups;
  [[nodiscard]] Linearization Of() const {
    return {start.problem, layout, start.noise, weights, groups, groups.back() + 1};
  }
};
Fixed FixedFrom(SessionStart start) {
  // Large sigmas: no residual of the start is beyond Huber's knee, where the cost has a kink in its second derivative.
  for (SensorNoise& noise : start.noise) noise = {noise.sigma_rad > 0 ? 0.05 : 5.0, noise.sigma_rad > 0 ? 0.05 : 0.0};
  Fixed fixed{std::move(start), {}, {}, {}};
  fixed.layout = LayoutOf(fixed.start.problem);
  fixed.weights = FullWeights(fixed.start.problem);
  fixed.groups = GroupsOf(fixed.start.problem, fixed.start.state);
  return fixed;
}

// Away from the minimum the gradient of the reduced problem is that of the cost with the places at their best, so places
// are moved to where their own gradient vanishes first.
SessionState PlacesSettled(const Fixed& fixed, SessionState state) {
  for (int i = 0; i < 20; ++i) {
    const auto now = Linearize(fixed.Of(), state);
    std::vector<Vector6d> steps;
    for (const PlaceEquations& place : now->places) steps.emplace_back(-place.inverse * place.b);
    state = Moved(fixed.start.problem, fixed.layout, state, Eigen::VectorXd::Zero(fixed.layout.size), steps);
  }
  return state;
}

TEST(CalibJoint, GradientIsThatOfTheCostAwayFromItsMinimum) {
  const FeatureSession session = Visit(WithSeed(3));
  const Fixed fixed = FixedFrom(StartFrom(session));
  const SessionState state = PlacesSettled(fixed, fixed.start.state);
  const auto at = Linearize(fixed.Of(), state);
  ASSERT_TRUE(at);
  const Eigen::VectorXd gradient = 2 * at->Total().b.head(fixed.layout.size);
  const Eigen::MatrixXd H = at->Total().H;
  ASSERT_GT(gradient.cwiseAbs().maxCoeff(), 1.0);  // nominal poses are off
  const std::vector<Vector6d> still(state.T_world_ref.size(), Vector6d::Zero());
  for (int i = 0; i < fixed.layout.size; ++i) {
    const double h = 1e-3 / std::sqrt(H(i, i));
    const auto cost = [&](double step) {
      const SessionState moved = Moved(fixed.start.problem, fixed.layout, state,
                                       step * Eigen::VectorXd::Unit(fixed.layout.size, i), still);
      return Linearize(fixed.Of(), moved)->cost;
    };
    EXPECT_NEAR((cost(h) - cost(-h)) / (2 * h), gradient[i], 2e-4 * std::abs(gradient[i]) + 1e-3 * std::sqrt(H(i, i)))
        << "unknown " << i;
  }
}

class GivenLenses : public testing::TestWithParam<sim::IntrinsicsKind> {};

TEST_P(GivenLenses, RefinedPosesAreWithinTheirSigmasOfTheTruth) {
  sim::Options options = WithSeed(5);
  options.intrinsics = GetParam();
  const FeatureSession session = Visit(options);
  const SessionStart start = StartFrom(session);
  EXPECT_TRUE(start.unused.empty());
  const Refined refined = RefinedFrom(start);
  const PoseCovariance covariance = CovarianceOfPoses(refined);
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const int row = covariance.row_of_sensor[s];
    if (row == kNone) continue;
    const Vector6d error =
        (refined.state.T_ref_sensor[s].Inverse() * session.experiment.T_ref_sensor(start.problem.sensors[s])).Log();
    const Matrix6d C = covariance.joint.block<6, 6>(row, row);
    EXPECT_LT(error.dot(C.ldlt().solve(error)), 60.0) << start.problem.sensors[s].str();  // of 6: one in 1e10
    EXPECT_LT(error.head<3>().norm(), 0.005);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, GivenLenses,
                         testing::Values(sim::IntrinsicsKind::kExact, sim::IntrinsicsKind::kCalibrated,
                                         sim::IntrinsicsKind::kAbsent));

TEST(CalibJoint, CovarianceIsNeverBelowTheModels) {
  const PoseCovariance covariance = CovarianceOfPoses(RefinedFrom(StartFrom(Visit(WithSeed(6)))));
  const Eigen::VectorXd scale = covariance.model.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(scale.asDiagonal() * (covariance.joint - covariance.model) *
                                                            scale.asDiagonal());
  EXPECT_GT(axes.eigenvalues()[0], -1e-9);
}

TEST(CalibJoint, NoiseOfEachSensorIsFoundFromItsResiduals) {
  const FeatureSession session = Visit(WithSeed(7));
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const sim::RigSensor& truth = session.experiment.rig.SensorOf(start.problem.sensors[s]);
    if (truth.kind == SensorKind::kCamera) {
      EXPECT_NEAR(refined.noise[s].sigma, truth.camera.corner_sigma_px, 0.1 * truth.camera.corner_sigma_px);
    }
    if (truth.kind == SensorKind::kTracker) {
      EXPECT_NEAR(refined.noise[s].sigma_rad, truth.tracker.sigma_rad, 0.6 * truth.tracker.sigma_rad);
    }
  }
}

class BumpedSensor : public testing::TestWithParam<std::tuple<const char*, double, double>> {};

TEST_P(BumpedSensor, IsNamedWithItsCapture) {
  const auto [name, move_m, turn_rad] = GetParam();
  sim::Options options = WithSeed(8);
  options.bump = SensorId(name);
  options.bump_m = move_m;
  options.bump_rad = turn_rad;
  const SessionStart start = StartFrom(Visit(options));
  const Refined refined = RefinedFrom(start);
  const std::vector<Move> moves = ScanForMoves(refined);
  ASSERT_FALSE(moves.empty());
  ASSERT_NE(moves[0].sensor, kNone) << "a board: " << start.problem.boards[static_cast<std::size_t>(moves[0].board)].str();
  EXPECT_EQ(start.problem.sensors[static_cast<std::size_t>(moves[0].sensor)].str(), name);
  EXPECT_NEAR(moves[0].group, kCaptures / 2, 1);
  EXPECT_LT(moves[0].odds, 1e-6);
  EXPECT_NEAR(moves[0].step.head<3>().norm(), move_m, 0.5 * move_m);
}

INSTANTIATE_TEST_SUITE_P(Sizes, BumpedSensor,
                         testing::Values(std::tuple("front_right", 0.02, 0.035), std::tuple("back", 0.005, 0.0087),
                                         std::tuple("front_left", 0.005, 0.0087),  // the reference
                                         std::tuple("lidar_vertical", 0.02, 0.035)));

TEST(CalibJoint, NoSensorIsAccusedWhereNoneMoved) {
  for (const std::uint64_t seed : {11, 12, 13}) {
    const SessionStart start = StartFrom(Visit(WithSeed(seed)));
    const std::vector<Move> moves = ScanForMoves(RefinedFrom(start));
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

SessionEstimate EstimateFrom(const FeatureSession& session) {
  SessionEstimate estimate = EstimateSession(ViewsOf(session, NominalPoses(session)));
  EXPECT_TRUE(estimate.why_not.empty());
  return estimate;
}

// Told moved in a session in which it was shifted and turned so.
void ExpectToldMoved(sim::Options options, const char* sensor, double shift_m, double turn_rad) {
  options.bump = SensorId(sensor);
  options.bump_m = shift_m;
  options.bump_rad = turn_rad;
  const SessionEstimate bumped = EstimateFrom(Visit(options));
  ASSERT_EQ(bumped.moved.size(), 1u) << sensor << ", seed " << options.seed << ": " << shift_m << " m, " << turn_rad << " rad";
  EXPECT_EQ(bumped.moved[0].sensor.str(), sensor);
}

TEST(CalibJoint, AMoveAsSmallAsASessionSaysItWouldTellIsTold) {
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

TEST(CalibJoint, TooFewCapturesTellNoMove) {
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

TEST(CalibJoint, OnePictureOfAnotherInstantCostsLittleAndIsHeldBack) {
  FeatureSession session = Visit(WithSeed(9));
  auto& views = session.seen.views.at(SensorId("front_right"));
  const auto bad = std::next(views.begin(), 4);
  for (Eigen::Vector2d& corner : bad->second.corners_px) corner.x() += 8.0;
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  for (std::size_t i = 0; i < start.problem.corners.size(); ++i) {
    const CornersSeen& seen = start.problem.corners[i];
    const bool is_bad = start.problem.sensors[static_cast<std::size_t>(seen.sensor)] == SensorId("front_right") &&
                        start.problem.captures[static_cast<std::size_t>(
                            start.problem.capture_of_place[static_cast<std::size_t>(seen.place)])] == bad->first;
    if (is_bad) {
      EXPECT_LT(refined.weights.corners[i], 0.01);
    } else {
      EXPECT_GT(refined.weights.corners[i], 0.99) << i;
    }
  }
  const Refined clean = RefinedFrom(StartFrom(Visit(WithSeed(9))));
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s) {
    const Vector6d apart = (clean.state.T_ref_sensor[s].Inverse() * refined.state.T_ref_sensor[s]).Log();
    EXPECT_LT(apart.head<3>().norm(), 5e-4) << start.problem.sensors[s].str();
  }
}

TEST(CalibJoint, CapturesWithoutLeadingZerosAreInTheOrderInWhichTheyWereTaken) {
  FeatureSession session = Visit(WithSeed(3));
  const auto plain = [](const CaptureId& capture) { return CaptureId(std::to_string(std::stoi(capture.str()))); };
  SessionViews views = ViewsOf(session, NominalPoses(session));
  for (CameraViews& camera : views.cameras) {
    for (auto& [capture, view] : camera.views) capture = plain(capture);
    std::map<CaptureId, Se3> poses;
    for (const auto& [capture, pose] : camera.estimate.T_cam_board) poses.emplace(plain(capture), pose);
    camera.estimate.T_cam_board.clear();
    for (const auto& [capture, pose] : poses) camera.estimate.T_cam_board.emplace(capture, pose);
  }
  for (TrackerPoses& tracker : views.trackers)
    for (TimedPose& row : tracker.poses) row.capture = plain(row.capture);
  views.lidars.clear();
  const auto start = StartOf(views);
  ASSERT_TRUE(start) << Sentence(start.error());
  ASSERT_GT(start->problem.captures.size(), 10u);
  for (std::size_t i = 1; i < start->problem.captures.size(); ++i)
    EXPECT_LT(std::stoi(start->problem.captures[i - 1].str()), std::stoi(start->problem.captures[i].str()));
}

TEST(CalibJoint, SensorThatSawNothingDoesNotRefuseTheSession) {
  const FeatureSession session = Visit(WithSeed(4));
  SessionViews views = ViewsOf(session, NominalPoses(session));
  for (LidarViews& lidar : views.lidars)
    if (lidar.lidar.id == SensorId("lidar_vertical")) lidar.clouds.clear();
  const SessionEstimate estimate = EstimateSession(views);
  ASSERT_TRUE(estimate.why_not.empty()) << estimate.why_not.front().what;
  std::set<SensorId> refined;
  for (const RefinedPose& pose : estimate.poses) refined.insert(pose.sensor);
  EXPECT_FALSE(refined.contains(SensorId("lidar_vertical")));
  EXPECT_TRUE(refined.contains(SensorId("lidar_horizontal")));
  EXPECT_EQ(refined.size() + 1, views.T_ref_sensor.size());
}

// Waves across the picture, of another length along u than along v.
Eigen::Vector2d BentBy(double amplitude_px, const Eigen::Vector2d& uv_px) {
  const Eigen::Vector2d turn = 2 * M_PI * uv_px / 2448;
  return amplitude_px * Eigen::Vector2d(std::sin(2.2 * turn.x() + 0.9 * turn.y()), std::cos(1.8 * turn.y() - turn.x()));
}

void Bend(const char* camera, double amplitude_px, FeatureSession& session) {
  for (auto& [capture, view] : session.seen.views.at(SensorId(camera)))
    for (Eigen::Vector2d& corner : view.corners_px) corner += BentBy(amplitude_px, corner);
}

double T2(const FeatureSession& session, const SensorId& sensor, const Se3& T_ref_sensor, const Matrix6d& C) {
  const Vector6d error = (T_ref_sensor.Inverse() * session.experiment.T_ref_sensor(sensor)).Log();
  return error.dot(C.ldlt().solve(error));
}

// Of the sensor whose pose is told worst: squared error in sigmas; 6 are expected.
double WorstT2(const FeatureSession& session, const SessionEstimate& estimate) {
  double worst = 0;
  for (std::size_t i = 0; i < estimate.poses.size(); ++i)
    if (const int row = RowOf(estimate, i); row >= 0)
      worst = std::max(worst, T2(session, estimate.poses[i].sensor, estimate.poses[i].T_ref_sensor,
                                 estimate.covariance.block<6, 6>(row, row)));
  return worst;
}

double WorstT2WithoutFields(const FeatureSession& session) {
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  const PoseCovariance covariance = CovarianceOfPoses(refined);
  double worst = 0;
  for (std::size_t s = 0; s < start.problem.sensors.size(); ++s)
    if (const int row = covariance.row_of_sensor[s]; row != kNone)
      worst = std::max(worst, T2(session, start.problem.sensors[s], refined.state.T_ref_sensor[s],
                                 covariance.joint.block<6, 6>(row, row)));
  return worst;
}

TEST(CalibJoint, ALensThatBendsBeyondItsModelIsNamedAloneAndCovered) {
  FeatureSession session = Visit(WithSeed(14));
  Bend("right_back", 0.2, session);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.misfits.size(), 1u);
  EXPECT_EQ(estimate.misfits[0].camera.str(), "right_back");
  EXPECT_GT(estimate.misfits[0].rms_px, 0.05);
  EXPECT_LT(estimate.misfits[0].rms_px, 0.2);
  EXPECT_GT(estimate.misfits[0].sigma_ratio, 1.5);
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_LT(WorstT2(session, estimate), 25.0);  // of one sensor by chance: one in 3,000
  EXPECT_GT(WorstT2WithoutFields(session), 40.0);
}

TEST(CalibJoint, EveryLensMayBend) {
  FeatureSession session = Visit(WithSeed(15));
  for (const auto& [camera, views] : FeatureSession(session).seen.views) Bend(camera.str().c_str(), 0.1, session);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_EQ(estimate.misfits.size(), 9u);
  EXPECT_TRUE(estimate.moved.empty());
  EXPECT_LT(WorstT2(session, estimate), 30.0);
}

TEST(CalibJoint, NoLensIsAccusedWhereNoneBends) {
  for (const std::uint64_t seed : {11, 12, 13}) EXPECT_TRUE(EstimateFrom(Visit(WithSeed(seed))).misfits.empty()) << seed;
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

TEST(CalibJoint, AMoveTooSmallToTellDividesNoSession) {
  for (const char* sensor : {"right_back", "front_left"}) {  // the reference, too
    const SessionEstimate estimate = EstimateFrom(BumpedVisit(sensor, 0.0006, 0.5));
    EXPECT_TRUE(estimate.moved.empty()) << sensor;
    EXPECT_EQ(SmallestMoveOf(estimate, sensor).captures, SmallestMoveOf(EstimateFrom(Visit(WithSeed(20))), sensor).captures);
  }
}

TEST(CalibJoint, ASensorThatMovedTwiceHasItsLastPose) {
  FeatureSession session = BumpedVisit("back", 0.01, 1.0 / 3);
  const FeatureSession later = BumpedVisit("back", 0.03, 2.0 / 3);
  for (auto& [capture, view] : session.seen.views.at(SensorId("back")))
    if (capture >= session.experiment.captures[2 * kCaptures / 3]) view = later.seen.views.at(SensorId("back")).at(capture);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.moved.size(), 2u);
  const Se3 first = PoseIn(EstimateFrom(Visit(WithSeed(20))), "back");
  EXPECT_NEAR(ShiftBetween_m(first, PoseIn(estimate, "back")), 0.03, 0.002);
}

TEST(CalibJoint, ABoardThatMovedIsNamedAndCostsNoPose) {
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

TEST(CalibJoint, ABumpIsNoBentLensAndABentLensNoBump) {
  sim::Options options = WithSeed(16);
  options.bump = SensorId("left_front");
  options.bump_m = 0.005;
  options.bump_rad = 0.0087;
  FeatureSession session = Visit(options);
  const SessionEstimate bumped = EstimateFrom(session);
  ASSERT_EQ(bumped.moved.size(), 1u);
  EXPECT_EQ(bumped.moved[0].sensor.str(), "left_front");
  EXPECT_NEAR(bumped.moved[0].step.head<3>().norm(), options.bump_m, 0.1 * options.bump_m);
  EXPECT_NEAR(bumped.moved[0].step.tail<3>().norm(), options.bump_rad, 0.1 * options.bump_rad);
  EXPECT_TRUE(bumped.misfits.empty());
  Bend("back", 0.2, session);
  const SessionEstimate both = EstimateFrom(session);
  ASSERT_EQ(both.moved.size(), 1u);
  EXPECT_EQ(both.moved[0].sensor.str(), "left_front");
  ASSERT_EQ(both.misfits.size(), 1u);
  EXPECT_EQ(both.misfits[0].camera.str(), "back");
}

TEST(CalibJoint, SaysWhyThereIsNothingToRefine) {
  FeatureSession session = Visit(WithSeed(10));
  for (auto& [camera, views] : session.seen.views)
    for (auto& [capture, view] : views) view.found = false;
  const auto start = StartOf(ViewsOf(session, NominalPoses(session)));
  ASSERT_FALSE(start);
  EXPECT_THAT(start.error().what, testing::HasSubstr("no picture of a board"));
}

}  // namespace
}  // namespace rigcal::calib::joint
