// What a session contradicts or cannot tell is in what it says of itself, not in one pose that looks sure.
#include <algorithm>

#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

const SensorId kAcross("lidar_horizontal"), kUpright("lidar_vertical");

FeatureSession LongVisit(sim::Options options) {
  options.captures = 24;
  auto experiment = sim::Prepare(*sim::LoadRig("mars-mapper"), options);
  return RecordFeatures(*experiment, 0);
}

TEST(JointDoubt, ALidarThatWasKnockedFarLosesSightAndIsNamed) {
  sim::Options options = WithSeed(41);
  options.bump = kUpright;
  options.bump_m = 0.05;
  options.bump_rad = 0.45;
  options.bump_at_ratio = 0.75;
  const FeatureSession session = LongVisit(options);
  const SessionEstimate estimate = EstimateFrom(session);
  ASSERT_EQ(estimate.lost_sights.size(), 1u);
  const LostSight& loss = estimate.lost_sights[0];
  EXPECT_EQ(loss.sensor, kUpright);
  EXPECT_EQ(loss.first_lost, session.experiment.captures[18]);
  EXPECT_EQ(loss.last_seen, session.experiment.captures[17]);
  EXPECT_EQ(loss.seen, 18);
  EXPECT_EQ(loss.lost, 6);
}

TEST(JointDoubt, LidarsThatStayLoseNothing) {
  for (const std::uint64_t seed : {42, 43}) EXPECT_TRUE(EstimateFrom(LongVisit(WithSeed(seed))).lost_sights.empty());
}

// Found by chance in a few captures, all over the session.
TEST(JointDoubt, BoardsMissedNowAndThenAreNoLoss) {
  FeatureSession session = LongVisit(WithSeed(44));
  int capture = 0;
  for (auto& [id, clouds] : session.seen.clouds.at(kUpright)) {
    if (++capture % 5 != 0) continue;
    for (auto& [target, cloud] : clouds)
      for (PlanePatch& patch : cloud.candidates) patch.centre_m += Eigen::Vector3d(0, 0, 1);
  }
  EXPECT_TRUE(EstimateFrom(session).lost_sights.empty());
}

SessionViews WithRelative(const FeatureSession& session, const Vector6d& wrong, int dof) {
  SessionViews views = ViewsOf(session, NominalPoses(session));
  const Se3 T_a_b =
      session.experiment.T_ref_sensor(kAcross).Inverse() * session.experiment.T_ref_sensor(kUpright) * Se3::Exp(wrong);
  Matrix6d Omega = 1e6 * Matrix6d::Identity();  // 1 mm, 1 mrad
  views.relatives.push_back({kAcross, kUpright, T_a_b, Omega, dof});
  return views;
}

TEST(JointDoubt, CloudsLaidWronglyOnEachOtherMoveNoPoseAndAreNamed) {
  for (const int dof : {0, 20}) {
    const FeatureSession session = Visit(WithSeed(45));
    const Vector6d wrong = (Vector6d() << 0.02, 0, 0.01, 0, 0.005, 0).finished();
    const SessionEstimate estimate = EstimateSession(WithRelative(session, wrong, dof));
    ASSERT_EQ(estimate.contradicted.size(), 1u);
    EXPECT_EQ(estimate.contradicted[0].a, kAcross);
    EXPECT_EQ(estimate.contradicted[0].b, kUpright);
    EXPECT_NEAR(estimate.contradicted[0].off.head<3>().norm(), 0.0224, 0.004);
    const SessionEstimate without = EstimateFrom(session);
    EXPECT_LT((estimate.covariance - without.covariance).norm(), 0.05 * without.covariance.norm());
    EXPECT_LT(WorstT2(session, estimate), 30.0);
  }
}

TEST(JointDoubt, CloudsLaidWellOnEachOtherCount) {
  const FeatureSession session = Visit(WithSeed(45));
  const SessionEstimate estimate = EstimateSession(WithRelative(session, Vector6d::Zero(), 20));
  EXPECT_TRUE(estimate.contradicted.empty());
  EXPECT_LT(estimate.covariance.trace(), EstimateFrom(session).covariance.trace());
}

// Half of a step that is none of chance, and too small to be told, is in the pose.
TEST(JointDoubt, AMoveTooSmallToTellIsInTheSigma) {
  sim::Options options = WithSeed(20);
  options.bump = SensorId("right_back");
  options.bump_m = 0.0009;
  options.bump_rad = 0.0;
  options.bump_at_ratio = 0.5;
  const FeatureSession session = Visit(options);
  const SessionEstimate moved = EstimateFrom(session), still = EstimateFrom(Visit(WithSeed(20)));
  ASSERT_TRUE(moved.moved.empty());
  const auto found = std::find_if(moved.poses.begin(), moved.poses.end(),
                                  [](const RefinedPose& pose) { return pose.sensor.str() == "right_back"; });
  const int row = RowOf(moved, static_cast<std::size_t>(found - moved.poses.begin()));
  const auto sigma_m = [&](const SessionEstimate& of) {
    return std::sqrt(of.covariance.block<3, 3>(row, row).trace());
  };
  EXPECT_GT(sigma_m(moved), 0.0004);
  EXPECT_LT(sigma_m(still), 0.0003);
}

// The session says 1 ms of a clock that is 40 ms late: what that pulls it by is in the poses' sigmas.
TEST(JointDoubt, AClockThatIsGivenWronglyIsInTheSigma) {
  sim::Options options = WithSeed(46);
  options.disturb.sway_per_s = {0.2, 0.17};
  options.disturb.pose_clock_late_s = 0.04;
  const FeatureSession session = Visit(options);
  SessionViews views = ViewsOf(session, NominalPoses(session));
  views.trackers[0].tracker.clock_sigma_s = 0.001;
  const SessionEstimate estimate = EstimateSession(views);
  ASSERT_EQ(estimate.clocks.size(), 1u);
  EXPECT_FALSE(estimate.clocks[0].IsKnown());
  EXPECT_LT(WorstT2(session, estimate), 40.0);
}

}  // namespace
}  // namespace rigcal::calib::joint
