// Cameras that are off as a whole from capture to capture: the virtual robot's mounts rattle.
#include <gmock/gmock.h>

#include "server/calib/joint/problem/observation.h"
#include "tests/unit/calib/joint/visit.h"

namespace rigcal::calib::joint {
namespace {

TEST(LookError, MountsThatRattleAreInTheSigmasAndNobodyIsAccused) {
  for (const double sigma_m : {3e-4}) {
    sim::Options options = WithSeed(2);
    options.disturb.rattle = {sigma_m, sigma_m};
    const FeatureSession session = Visit(options);
    const SessionEstimate estimate = EstimateFrom(session);
    ASSERT_THAT(estimate.why_not, testing::IsEmpty());
    EXPECT_LT(WorstT2(session, estimate), 30.0) << sigma_m;
    EXPECT_THAT(estimate.moved, testing::IsEmpty());
    EXPECT_THAT(estimate.late, testing::IsEmpty());
    EXPECT_FALSE(estimate.look_scatter.empty());
    // Boards are some two metres away: a shift by sigma_m is half of that angle.
    for (const LookScatter& one : estimate.look_scatter) EXPECT_NEAR(one.sigma_rad / sigma_m, 0.75, 0.35);
  }
}

TEST(LookError, IsNoneInASessionWhereNothingRattles) {
  const FeatureSession session = Visit(WithSeed(2));
  const SessionStart start = StartFrom(session);
  const Refined refined = RefinedFrom(start);
  EXPECT_FALSE(LooksErr(start.problem, refined.noise));
  EXPECT_LT(LooksBesideEachOther(start.problem, refined), 1.2);  // 2 would be beyond what corners do
  EXPECT_THAT(EstimateFrom(session).look_scatter, testing::IsEmpty());
}

// One camera that sits loose among others that do not.
TEST(LookError, IsToldOfTheOneThatSitsLoose) {
  sim::Options options = WithSeed(2);
  FeatureSession session = Visit(options);
  options.disturb.rattle = {3e-4, 3e-4};
  const SensorId loose("left_front");
  session.seen.views.at(loose) = Visit(options).seen.views.at(loose);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 30.0);
  EXPECT_THAT(estimate.moved, testing::IsEmpty());
  ASSERT_EQ(estimate.look_scatter.size(), 1u);
  EXPECT_EQ(estimate.look_scatter[0].camera, loose);
}

TEST(LookError, IsTheSameInBursts) {
  sim::Options options = WithSeed(4);
  options.captures = 40;
  options.disturb.burst = 4;
  options.disturb.rattle = {3e-4, 3e-4};
  const FeatureSession session = RecordFeatures(*sim::Prepare(*sim::LoadRig("mars-mapper"), options), 0);
  const SessionEstimate estimate = EstimateFrom(session);
  EXPECT_LT(WorstT2(session, estimate), 30.0);
  EXPECT_THAT(estimate.moved, testing::IsEmpty());
  EXPECT_FALSE(estimate.look_scatter.empty());
  for (const LookScatter& one : estimate.look_scatter) EXPECT_NEAR(one.sigma_rad / 3e-4, 0.75, 0.35);
}

// What one look says of its sensor's pose.
struct OfSensor {
  double cost;
  Vector6d gradient;
  Matrix6d normal;
};
OfSensor LookAt(const SessionStart& start, const SessionState& state, const CornersSeen& seen, double weight) {
  const auto look = Observe(start.problem, LayoutOf(start.problem), state, seen, {0.03, 2e-4}, weight);
  const Eigen::MatrixXd& by = look->columns.front().by;
  return {look->cost, by.transpose() * look->b, by.transpose() * look->A * by};
}

// The error of a look is eliminated: what is left is the gradient of the cost at its best error, by central
// differences.
TEST(LookError, GradientAndNormalMatrixAreThoseOfTheCost) {
  sim::Options options = WithSeed(2);
  options.disturb.rattle = {3e-4, 3e-4};
  SessionStart start = StartFrom(Visit(options));
  start.noise = WithLooksThatErr(start.problem, start.noise);
  const SessionState state = RefinedFrom(start).state;
  const CornersSeen& seen = start.problem.corners.back();
  ASSERT_NE(seen.sensor, start.problem.reference);
  const OfSensor here = LookAt(start, state, seen, 1.0);
  const auto moved = [&](int axis, double by) {
    SessionState there = state;
    Se3& T = there.T_ref_sensor[static_cast<std::size_t>(seen.sensor)];
    T = T * Se3::Exp(by * Vector6d::Unit(axis));
    return LookAt(start, there, seen, 1.0);
  };
  constexpr double kStep = 1e-5;
  for (int axis = 0; axis < 6; ++axis) {
    const OfSensor more = moved(axis, kStep), less = moved(axis, -kStep);
    EXPECT_NEAR((more.cost - less.cost) / (4 * kStep), here.gradient[axis], 0.01 * here.gradient.norm()) << axis;
    EXPECT_LT(((more.gradient - less.gradient) / (2 * kStep) - here.normal.col(axis)).norm(),
              0.05 * here.normal.col(axis).norm())
        << axis;
  }
  const OfSensor half = LookAt(start, state, seen, 0.5);
  EXPECT_NEAR(half.cost, 0.5 * here.cost, 1e-9 * here.cost);
  EXPECT_LT((half.gradient - 0.5 * here.gradient).norm(), 1e-9 * here.gradient.norm());
}

TEST(LookError, ABumpBesideItIsFound) {
  sim::Options options = WithSeed(3);
  options.disturb.rattle = {2e-4, 2e-4};
  options.bump = SensorId("left_front");
  options.bump_m = 0.02, options.bump_rad = 0.03;
  const SessionEstimate estimate = EstimateFrom(Visit(options));
  ASSERT_EQ(estimate.moved.size(), 1u);
  EXPECT_EQ(estimate.moved[0].sensor, SensorId("left_front"));
}

}  // namespace
}  // namespace rigcal::calib::joint
