// What a revision says of each of its sensors: moved, beyond tolerance, uncertain, unknown.
#include "server/fleet/status/sensor_status.h"

#include <gmock/gmock.h>

namespace rigcal::fleet {
namespace {

using ::testing::HasSubstr;

const SensorId kLeft("left"), kRight("right"), kTop("top");

SensorPose Known(const SensorId& sensor, double sigma_m) {
  SensorPose pose;
  pose.sensor = sensor;
  pose.known = true;
  pose.covariance = Matrix6d::Identity() * sigma_m * sigma_m;
  return pose;
}

struct Rig {
  GraphSolution solution;
  Policy policy;
  std::optional<AsFound> found;
  DriftSteps steps;
  VerdictLevel level = VerdictLevel::kPass;
  VerdictBasis basis;
  std::optional<Stamp> calibrated_at = ParseIso("2026-11-10").value(), in_use_captured_at;

  Rig() { solution.poses = {Known(kLeft, 0.0), Known(kRight, 1e-3), Known(kTop, 1e-3)}; }
  [[nodiscard]] StatusFacts Judge() const {
    return JudgeStatus({RobotId("r"),
                        solution,
                        kLeft,
                        policy,
                        found,
                        steps,
                        calibrated_at,
                        kDefaultMaxAge_ns,
                        in_use_captured_at,
                        {{level, basis}}});
  }
  void Move(const SensorId& sensor, double m, const SensorId& or_else = {}) {
    found.emplace();
    found->in_use = 2;
    found->made_at = ParseIso("2026-11-26").value();  // solved anew since
    in_use_captured_at = ParseIso("2026-11-03").value();
    found->captured_at = ParseIso("2026-11-10").value();
    found->sensors.emplace_back();
    found->sensors.back().sensor = sensor;
    found->sensors.back().or_else = or_else;
    found->sensors.back().state = FoundState::kDrifted;
    found->sensors.back().axes.fill(FoundState::kDrifted);
    found->sensors.back().change(0) = m;
    found->sensors.back().sigma.setConstant(2e-4);
  }
};

CalibrationStatus Of(const SensorId& sensor, const StatusFacts& facts) {
  for (const SensorStatus& one : facts.sensors)
    if (one.sensor == sensor) return one.status;
  return {StatusWord::kUnknown, "there is none", ""};
}

TEST(SensorStatus, WhatTheVerdictAccusesOrDoubtsIsNotOk) {
  Rig rig;
  rig.level = VerdictLevel::kFail;
  rig.basis.culprits = {kTop};
  EXPECT_EQ(Of(kTop, rig.Judge()).word, StatusWord::kFailed);
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kOk);
  rig.level = VerdictLevel::kUnknown;
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kUnknown) << "it names nobody: none is verified";
  rig.basis.doubted = {kRight};
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kUnknown);
  EXPECT_EQ(Of(kTop, rig.Judge()).word, StatusWord::kOk);
}

TEST(SensorStatus, IsOkWhereNothingSpeaksAgainstIt) {
  const StatusFacts facts = Rig().Judge();
  ASSERT_EQ(facts.sensors.size(), 3u);
  for (const SensorStatus& one : facts.sensors) EXPECT_EQ(one.status, CalibrationStatus{}) << one.sensor.str();
}

TEST(SensorStatus, OfASensorThatMovedNamesItAndSinceWhen) {
  Rig rig;
  rig.Move(kRight, 1.2e-3);
  const CalibrationStatus status = Of(kRight, rig.Judge());
  EXPECT_EQ(status.word, StatusWord::kDrifted);
  EXPECT_THAT(status.why, HasSubstr("right moved by 1.2 mm"));
  EXPECT_THAT(status.why, HasSubstr("since revision 2, captured 3 Nov 2026; the calibration was updated."));
  EXPECT_THAT(status.next_step, HasSubstr("Check its mount"));
  EXPECT_EQ(FoundOf(rig.Judge()), status);
}

TEST(SensorStatus, BeyondTheToleranceSaysWhatMayBeAffected) {
  Rig rig;
  rig.Move(kRight, 8e-3, kTop);
  const CalibrationStatus status = Of(kRight, rig.Judge());
  EXPECT_EQ(status.word, StatusWord::kOutOfTolerance);
  EXPECT_THAT(status.why, HasSubstr("right or top moved by 8 mm"));
  EXPECT_THAT(status.why, HasSubstr("what was done from 3 Nov 2026 to 10 Nov 2026 may be affected"));
  rig.in_use_captured_at = ParseIso("2026-11-12").value();
  EXPECT_THAT(Of(kRight, rig.Judge()).why, HasSubstr("what was done before 10 Nov 2026 may be affected"));
  rig.policy.sensors[kRight].tolerance_m = 0.02;
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kDrifted) << "the policy allows it";
}

TEST(SensorStatus, AnUncertainPoseIsOutOfTolerance) {
  Rig rig;
  rig.solution.poses[2] = Known(kTop, 6e-3);
  const CalibrationStatus status = Of(kTop, rig.Judge());
  EXPECT_EQ(status.word, StatusWord::kOutOfTolerance);
  EXPECT_THAT(status.why, HasSubstr("The pose of top is known to 6 mm"));
  EXPECT_THAT(status.why, HasSubstr("since 10 Nov 2026 may be affected"));
}

// Each visit found it unchanged, as each one updates the calibration: it is their line that tells.
TEST(SensorStatus, OfASensorThatGoesOnDriftingNamesItsRate) {
  Rig rig;
  rig.Move(kRight, 0.3e-3);
  SensorFound& right = rig.found->sensors.back();
  right.state = FoundState::kUnchanged;
  right.axes.fill(FoundState::kUnchanged);
  rig.found->tests = 12;
  right.rate = DriftRate{12, ParseIso("2026-09-03").value(), ParseIso("2026-11-10").value()};
  right.rate->per_30_days(0) = 1.2e-3;
  right.rate->sigma_per_30_days.setConstant(5e-5);
  const CalibrationStatus status = Of(kRight, rig.Judge());
  EXPECT_EQ(status.word, StatusWord::kDrifted);
  EXPECT_THAT(status.why,
              HasSubstr("right drifts by 1.2 mm in 30 days (24 sigma, 12 visits since 3 Sep 2026; the smallest drift"));
  EXPECT_THAT(status.next_step, HasSubstr("Check its mount"));
  EXPECT_EQ(FoundOf(rig.Judge()), status);
  right.rate->per_30_days(0) = 0.3e-3;  // 0.9 mm in the 90 days that are allowed: within moved_min
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kOk);
  right.rate->per_30_days(0) = 1.2e-3;
  right.rate->visits = 3;
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kOk) << "three visits are no test of a line";
}

TEST(SensorStatus, WithoutAPoseItIsUnknownAndWithTwoItFailed) {
  Rig rig;
  rig.solution.poses[1].known = false;
  rig.solution.suspects.two_poses.push_back({kTop, {}, {}});
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kUnknown);
  EXPECT_EQ(Of(kTop, rig.Judge()).word, StatusWord::kOk) << "a verdict that passes asks for nothing to be done";
  rig.level = VerdictLevel::kFail;
  EXPECT_EQ(Of(kTop, rig.Judge()).word, StatusWord::kFailed);
  rig.solution.poses[1].measured_part = MeasuredPart{};
  EXPECT_EQ(Of(kRight, rig.Judge()).why, "The pose of right was measured in part only.");
}

// As on a level floor, whose height nobody needs.
TEST(SensorStatus, WhatThePolicyDoesNotNeedIsNotMissed) {
  Rig rig;
  SensorPose& right = rig.solution.poses[1];
  right.known = false;
  right.unobservable_basis = {Vector6d::Unit(tangent::kZ)};
  right.measured_part = MeasuredPart{};
  right.measured_part->covariance.diagonal() << 1e-6, 1e-6, 0, 1e-6, 1e-6, 1e-6;
  rig.policy.all.not_needed = {"z of left"};
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kOk);
  right.measured_part->covariance(0, 0) = 0.012 * 0.012;
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kOutOfTolerance) << "the rest has to be known";
  rig.policy.all.not_needed = {"y of left"};
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kUnknown);
}

TEST(SensorStatus, WhatWasNotTestedMovedNobody) {
  Rig rig;
  rig.Move(kRight, 8e-3);
  rig.found->why_not = "No calibration was in use before it.";
  EXPECT_EQ(Of(kRight, rig.Judge()).word, StatusWord::kOk);
  DriftSteps steps;
  AddSteps(RobotId("r"), *rig.found, 7.0, steps);
  EXPECT_TRUE(steps.empty());
}

// Taken out of changes as their noise, an assumed scatter of 1.4 mm hides a drift of as much in a month.
TEST(SensorStatus, WhatOneVisitIsTestedAgainstIsNoStep) {
  Rig rig;
  rig.Move(kRight, 8e-3);
  for (const int visits : {0, 1, 2, 3}) {
    rig.found->visits = visits;
    DriftSteps steps;
    AddSteps(RobotId("r"), *rig.found, 30.0, steps);
    EXPECT_EQ(steps[kRight].size(), visits < 2 ? 0u : 1u) << visits;
  }
}

// That scatter was measured, by others.
TEST(SensorStatus, OneVisitIsAStepWhereOtherRobotsTellWhatVisitsScatterBy) {
  Rig rig;
  rig.Move(kRight, 8e-3);
  rig.found->visits = 1, rig.found->scatter_robots = 19;
  DriftSteps steps;
  AddSteps(RobotId("r"), *rig.found, 30.0, steps);
  EXPECT_EQ(steps[kRight].size(), 1u);
}

TEST(SensorStatus, IsDueByItsDriftAfterItWasMeasured) {
  Rig rig;
  for (int visit = 1; visit <= 8; ++visit) {
    DriftStep step{RobotId("r"), 7.0};
    step.change(visit % 3) = visit % 2 == 0 ? 2e-3 : -2e-3;
    step.sigma.setConstant(1e-4);
    rig.steps[kRight].push_back(step);
  }
  for (const SensorStatus& one : rig.Judge().sensors) {
    EXPECT_EQ(one.due.has_value(), one.sensor == kRight);
    if (!one.due) continue;
    EXPECT_GT(one.due->at, *rig.calibrated_at);
    EXPECT_LT(one.due->at.ns, rig.calibrated_at->ns + kDefaultMaxAge_ns);
    EXPECT_EQ(one.due->visits, 8);
    EXPECT_EQ(one.due->robots, 1);
  }
}

}  // namespace
}  // namespace rigcal::fleet
