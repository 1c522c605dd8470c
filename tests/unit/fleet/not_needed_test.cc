// A pose that lacks nothing but what the policy does not need: what the robot is told of it, and what is asked of the
// rest.
#include "server/fleet/findings/not_needed.h"

#include <gmock/gmock.h>

#include <cmath>

#include "server/fleet/findings/verdict_keys.h"
#include "tests/unit/fleet/rig.h"

namespace rigcal::fleet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kSigma_m = 1.4e-3;

// A body on a level floor: nobody measured how high it sits.
SensorPose LevelBody(double sigma_m = kSigma_m) {
  SensorPose pose = PoseOf("body", false);
  pose.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  pose.measured_part = MeasuredPart{};
  pose.measured_part->covariance =
      sigma_m * sigma_m * (Matrix6d::Identity() - pose.unobservable_basis[0] * pose.unobservable_basis[0].transpose());
  return pose;
}

struct LevelRig : Rig {
  Policy policy;
  LevelRig() {
    edges.push_back(MakeEdge('d', "left", "body"));
    edges.push_back(MakeEdge('e', "right", "body"));
    solution.poses.push_back(LevelBody());
    solution.R_ref_robot = Eigen::Matrix3d::Identity();
  }
  void Spare(std::set<std::string> results) { policy.sensors[SensorId("body")].not_needed = std::move(results); }
  [[nodiscard]] Verdict Judge() const { return Assess(edges, solution, policy); }
};

TEST(NotNeeded, WhatThePolicyDoesNotNeedIsToldByAPass) {
  LevelRig rig;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown) << "by default all of a pose is needed";
  EXPECT_EQ(rig.Judge().unverified, "body");
  rig.Spare({"height"});
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kPass) << verdict.why;
  EXPECT_THAT(verdict.why, HasSubstr(" of body was not measured, and the policy does not need it; the rest was, to "
                                     "1.4 mm and 0.08 deg. Every sensor is known well enough."));
  EXPECT_EQ(verdict.unverified, "");
  EXPECT_THAT(KeysOfVerdict(verdict, rig.edges, rig.solution, rig.policy, {}, {}), IsEmpty());
}

TEST(NotNeeded, WhatIsSaidOfAllHoldsUntilASensorHasAWordOfItsOwn) {
  LevelRig rig;
  rig.policy.all.not_needed = {"height", "yaw"};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  rig.Spare({});
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown) << "of this one all is needed";
}

TEST(NotNeeded, AnotherDirectionThatIsOpenStaysUnknown) {
  LevelRig rig;
  rig.Spare({"sideways", "yaw"});
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown);
  rig.Spare({"height"});
  rig.solution.poses.back().unobservable_basis.push_back(Vector6d::Unit(tangent::kX));
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown) << "the forward position is open, too";
  rig.Spare({"forward", "height"});
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  EXPECT_THAT(rig.Judge().why, HasSubstr("were not measured, and the policy does not need them"));
}

// Along no axis of the robot, nobody can say whether it is the height.
TEST(NotNeeded, ADirectionWithoutANameStaysUnknown) {
  LevelRig rig;
  rig.Spare({"height", "forward"});
  rig.solution.poses.back().unobservable_basis = {(Vector6d() << 1, 0, 1, 0, 0, 0).finished()};
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown);
}

// What the height is off by in the drawing would be told as forward, by a seventh of it.
TEST(NotNeeded, WhatIsOpenEightDegreesBesideTheHeightStaysUnknown) {
  LevelRig rig;
  rig.Spare({"height", "forward"});
  const auto open_at = [&](double angle_rad) {
    rig.solution.poses.back().unobservable_basis = {
        (Vector6d() << std::sin(angle_rad), 0, std::cos(angle_rad), 0, 0, 0).finished()};
  };
  open_at(4.0 / 180 * M_PI);
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
  open_at(8.0 / 180 * M_PI);
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown);
}

// A refinement that leaves a sensor out speaks for none of its pairs.
TEST(NotNeeded, PairsOfASensorThatNoRefinementTellsOfAreHeldAgainstIt) {
  LevelRig rig;
  rig.Spare({"height"});
  SessionEstimate estimate;
  estimate.session = SessionId(std::string(64, '1'));
  estimate.reference = SensorId("left");
  for (const char* sensor : {"right", "top"}) estimate.poses.push_back({SensorId(sensor), {}, 0.0, {}});
  for (Edge& edge : rig.edges) edge.session = estimate.session;
  rig.solution.fused.sessions = {estimate.session};
  rig.solution.residuals.push_back(ResidualOf(rig.edges[3], 0.03));
  rig.solution.residuals.push_back(ResidualOf(rig.edges[4], -0.03));
  const auto judged = [&] { return Assess(rig.edges, rig.solution, rig.policy, {}, {estimate}); };
  EXPECT_EQ(judged().level, VerdictLevel::kFail) << judged().why;
  estimate.poses.push_back({SensorId("body"), {}, 0.0, {}});
  EXPECT_EQ(judged().level, VerdictLevel::kPass) << "its refinement explains what pairs disagree by: " << judged().why;
}

TEST(NotNeeded, WithoutTheRobotsAxesThoseOfTheReferenceAreNamed) {
  LevelRig rig;
  rig.solution.R_ref_robot.reset();
  rig.Spare({"height"});
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown) << "nobody knows what is up";
  rig.Spare({"z of left"});
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
}

// What is z of one reference is another direction of the next one.
TEST(NotNeeded, AnAxisOfAnotherReferenceIsNotMeant) {
  LevelRig rig;
  rig.solution.R_ref_robot.reset();
  for (const char* other : {"z", "z of right", "y of left"}) {
    rig.Spare({other});
    EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown) << other;
  }
  rig.Spare({"z of left"});
  rig.solution.R_ref_robot = Eigen::Matrix3d::Identity();
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kUnknown) << "the robot's axes are known: its height is asked for";
}

TEST(NotNeeded, TheRestIsHeldToItsTolerance) {
  LevelRig rig;
  rig.Spare({"height"});
  rig.solution.poses.back() = LevelBody(0.012);
  const Verdict verdict = rig.Judge();
  EXPECT_EQ(verdict.level, VerdictLevel::kUnknown);
  EXPECT_EQ(verdict.unverified, "body (12 mm, limit 5 mm)");
  EXPECT_THAT(KeysOfVerdict(verdict, rig.edges, rig.solution, rig.policy, {}, {}), ElementsAre("uncertain body"));
  rig.policy.sensors[SensorId("body")].tolerance_m = 0.02;
  rig.policy.sensors[SensorId("body")].tolerance_rad = 0.02;
  EXPECT_EQ(rig.Judge().level, VerdictLevel::kPass);
}

TEST(NotNeeded, TheSolutionThatIsStoredStaysAsItIs) {
  LevelRig rig;
  EXPECT_FALSE(TakenAsKnown(rig.solution, rig.policy));
  rig.Spare({"height"});
  const auto taken = TakenAsKnown(rig.solution, rig.policy);
  ASSERT_TRUE(taken);
  EXPECT_TRUE(taken->poses.back().known);
  EXPECT_FALSE(rig.solution.poses.back().known);
  EXPECT_EQ(taken->poses.front().sensor, rig.solution.poses.front().sensor);
}

}  // namespace
}  // namespace rigcal::fleet
