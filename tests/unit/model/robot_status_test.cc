// The one word of a robot's status, case by case, and the dates beside it.
#include "server/model/robots/robot_status.h"

#include <gtest/gtest.h>

#include "server/model/robots/robot_summary.h"

namespace rigcal {
namespace {

const Stamp kNow = ParseIso("2027-01-10T12:00:00Z").value();
constexpr std::int64_t kDay_ns = 86'400'000'000'000;

Stamp DaysFromNow(int days) { return {kNow.ns + days * kDay_ns}; }

StatusBasis Measured(VerdictLevel level, int days_ago) {
  StatusBasis basis;
  basis.revision = 3;
  basis.verdict = {level, "why", "what to do"};
  basis.validity.calibrated_at = DaysFromNow(-days_ago);
  return basis;
}

DriftDue DriftIn(int days) { return {SensorId("lidar_vertical"), DaysFromNow(days), DriftLaw::kLinear, 12, 4}; }

StatusWord WordOf(const StatusBasis& basis) { return StatusAt(basis, kNow).word; }

TEST(RobotStatus, NamesAreReadBack) {
  for (const StatusWord word : kStatusWords) EXPECT_EQ(StatusWordOf(NameOf(word)), word);
  EXPECT_EQ(NameOf(StatusWord::kOutOfTolerance), "out-of-tolerance");
  EXPECT_EQ(StatusWordOf("fine"), StatusWord::kUnknown);
  EXPECT_EQ(DriftLawOf(NameOf(DriftLaw::kLinear)), DriftLaw::kLinear);
}

TEST(RobotStatus, IsOkUntilAWeekBeforeItIsDue) {
  EXPECT_EQ(WordOf(Measured(VerdictLevel::kPass, 0)), StatusWord::kOk);
  EXPECT_EQ(WordOf(Measured(VerdictLevel::kPass, 82)), StatusWord::kOk);
  EXPECT_EQ(WordOf(Measured(VerdictLevel::kPass, 84)), StatusWord::kDue);
  EXPECT_EQ(WordOf(Measured(VerdictLevel::kWarn, 90)), StatusWord::kDue);
  EXPECT_EQ(WordOf(Measured(VerdictLevel::kWarn, 91)), StatusWord::kOverdue);
}

// "Nothing is to be done" beside a warning that asks for something would be two truths.
TEST(RobotStatus, TheNextStepIsThatOfTheVerdictWhereItWarns) {
  EXPECT_EQ(StatusAt(Measured(VerdictLevel::kWarn, 0), kNow).next_step, "what to do");
  EXPECT_EQ(StatusAt(Measured(VerdictLevel::kPass, 0), kNow).next_step, "Nothing is to be done.");
}

TEST(RobotStatus, WhatHasNoDateIsNotKnownAndNotLate) {
  StatusBasis basis = Measured(VerdictLevel::kPass, 1);
  basis.validity.calibrated_at.reset();
  EXPECT_EQ(StatusAt(basis, kNow), (CalibrationStatus{StatusWord::kUnknown, "Nothing of it is calibrated.",
                                                      "Capture a session and push it."}));
}

TEST(RobotStatus, DriftMakesItDueAndNeverOverdue) {
  StatusBasis basis = Measured(VerdictLevel::kPass, 10);
  basis.drift_due = DriftIn(8);
  EXPECT_EQ(WordOf(basis), StatusWord::kOk);
  basis.drift_due = DriftIn(6);
  EXPECT_EQ(WordOf(basis), StatusWord::kDue);
  basis.drift_due = DriftIn(-30);
  EXPECT_EQ(WordOf(basis), StatusWord::kDue);
  EXPECT_EQ(StatusAt(basis, kNow).why, "It is due 31 Mar 2027 by age; 11 Dec 2026 by drift of lidar_vertical.");
}

TEST(RobotStatus, OfSeveralTheWorstIsTold) {
  StatusBasis basis = Measured(VerdictLevel::kPass, 100);
  basis.found = {StatusWord::kDrifted, "It moved.", "Check its mount."};
  EXPECT_EQ(WordOf(basis), StatusWord::kOverdue);
  basis.validity.calibrated_at = kNow;
  EXPECT_EQ(StatusAt(basis, kNow), basis.found);
  basis.found.word = StatusWord::kOutOfTolerance;
  basis.verdict.level = VerdictLevel::kUnknown;
  EXPECT_EQ(StatusAt(basis, kNow), basis.found);
  basis.found.word = StatusWord::kDrifted;
  EXPECT_EQ(WordOf(basis), StatusWord::kUnknown);
  basis.verdict.level = VerdictLevel::kFail;
  basis.found.word = StatusWord::kOutOfTolerance;
  EXPECT_EQ(WordOf(basis), StatusWord::kFailed);
  basis.revision = 0;
  EXPECT_EQ(WordOf(basis), StatusWord::kUnknown);
  EXPECT_EQ(StatusAt(basis, kNow).why, "why");
}

// Whose newest revision passes and is in use, measured today.
RobotSummary InUse(int revision) {
  RobotSummary robot;
  robot.robot = RobotId("rig");
  robot.revision = revision;
  robot.verdict = {VerdictLevel::kPass, "All is well.", ""};
  robot.validity.calibrated_at = kNow;
  robot.validity.usable = UsableRevision{revision, kNow, kNow};
  robot.state = RevisionState::kApproved;
  return robot;
}

RobotSummary WithCandidate(int revision) {
  RobotSummary robot = InUse(revision);
  robot.validity.usable->number = revision - 1;
  robot.validity.approved = false;
  robot.state = RevisionState::kCandidate;
  return robot;
}

TEST(RobotStatus, WhatWaitsForAWordIsWork) {
  EXPECT_EQ(StatusAt(InUse(2), kNow).next_step, "Nothing is to be done.");
  RobotSummary robot = WithCandidate(2);
  const CalibrationStatus status = StatusAt(robot, kNow);
  EXPECT_EQ(status.word, StatusWord::kToApprove);
  EXPECT_EQ(status.why, "Not approved: robots have revision 1, measured 10 Jan 2027, valid until 10 Apr 2027.");
  EXPECT_EQ(status.next_step, "`rigcal approve rig 2 --reason TEXT`, if it is right.");
  robot.state = RevisionState::kRejected;
  EXPECT_EQ(StatusAt(robot, kNow).word, StatusWord::kOk) << "somebody decided, and another is in use";
  robot.validity.usable.reset();
  EXPECT_EQ(StatusAt(robot, kNow).word, StatusWord::kToApprove) << "none is in use";
  EXPECT_EQ(StatusAt(robot, kNow).next_step,
            "Capture a session and push it, or approve a revision that is right: `rigcal history rig` lists them.");
}

TEST(RobotStatus, WhatIsNotAppliedIsWork) {
  RobotSummary robot = InUse(2);
  robot.runs = Runs{1, "It runs revision 1; revision 2 is in use: not applied yet.", "revision 1"};
  EXPECT_EQ(StatusAt(robot, kNow),
            (CalibrationStatus{StatusWord::kNotApplied, robot.runs->trouble,
                               "See to it that `rigcal agent` runs on the robot: it applies revision 2."}));
  robot.found = {StatusWord::kDrifted, "It moved.", "Check its mount."};
  EXPECT_EQ(StatusAt(robot, kNow).word, StatusWord::kNotApplied);
  EXPECT_EQ(StatusAt(robot, kNow).why, robot.runs->trouble + " It moved.");
  robot.runs->trouble.clear();
  EXPECT_EQ(StatusAt(robot, kNow), robot.found);
}

// What is worse is the word, and the next step says both.
TEST(RobotStatus, ACandidateMakesTheRobotNoYounger) {
  RobotSummary robot = WithCandidate(2);
  robot.validity.calibrated_at = robot.validity.usable->calibrated_at = DaysFromNow(-100);
  const CalibrationStatus status = StatusAt(robot, kNow);
  EXPECT_EQ(status.word, StatusWord::kOverdue);
  EXPECT_EQ(status.next_step,
            "`rigcal approve rig 2 --reason TEXT`, if it is right. Else: Capture a session and push it.");
  robot.verdict.level = VerdictLevel::kFail;
  robot.state = RevisionState::kUnusable;
  EXPECT_EQ(StatusAt(robot, kNow).word, StatusWord::kFailed);
}

TEST(RobotStatus, WhatWasFoundIsLookedAfterBeforeItIsApproved) {
  RobotSummary robot = WithCandidate(2);
  robot.found = {StatusWord::kDrifted, "It moved.", "Check its mount."};
  EXPECT_EQ(StatusAt(robot, kNow).word, StatusWord::kDrifted);
  EXPECT_EQ(StatusAt(robot, kNow).next_step,
            "Check its mount. Then: `rigcal approve rig 2 --reason TEXT`, if it is right.");
  robot.found.word = StatusWord::kOutOfTolerance;
  EXPECT_EQ(StatusAt(robot, kNow).next_step,
            "Check its mount. Then: `rigcal approve rig 2 --reason TEXT`, if it is right.");
}

TEST(RobotStatus, ARobotHasAWhileToApplyWhatIsInUse) {
  const RobotRuns first{{RobotId("rig"), {}, kNow, "agent"}, 1, kNow};
  const UsableRevision second{2, kNow};
  EXPECT_EQ(RunsOf(first, true, {}, second, kNow).apply_by, (Stamp{kNow.ns + kApplyWithin_ns}));
  EXPECT_FALSE(RunsOf(first, false, {}, second, kNow).apply_by) << "nobody ever approved it";
  EXPECT_FALSE(RunsOf(first, true, {}, std::nullopt, kNow).apply_by) << "nothing is in use";
  EXPECT_FALSE(RunsOf(first, true, {}, UsableRevision{1, kNow}, kNow).apply_by);
}

TEST(RobotStatus, ASensorIsWhatItIsOrAsDueAsItsRobot) {
  SensorStatus sensor{SensorId("left"), {}, DriftIn(3)};
  Validity validity;
  validity.calibrated_at = DaysFromNow(-5);
  EXPECT_EQ(StatusAt(sensor, validity, kNow).word, StatusWord::kDue);
  sensor.due.reset();
  EXPECT_EQ(StatusAt(sensor, validity, kNow).word, StatusWord::kOk);
  validity.calibrated_at = DaysFromNow(-95);
  EXPECT_EQ(StatusAt(sensor, validity, kNow).word, StatusWord::kOverdue);
  sensor.status.word = StatusWord::kOutOfTolerance;
  EXPECT_EQ(StatusAt(sensor, validity, kNow).word, StatusWord::kOutOfTolerance);
}

TEST(RobotStatus, TheEarlierDateHolds) {
  Validity validity;
  EXPECT_FALSE(DueAt(validity, DriftIn(1)));
  EXPECT_EQ(DueText(validity, DriftIn(1)), "");
  validity.calibrated_at = kNow;
  EXPECT_EQ(DueAt(validity, DriftIn(30)), DaysFromNow(30));
  EXPECT_EQ(DueAt(validity, DriftIn(300)), DaysFromNow(90));
  EXPECT_EQ(DueText(validity, DriftIn(300)), "due 10 Apr 2027 by age");
}

TEST(RobotStatus, OfARevisionTheWorstSensorAndTheEarliestDateStand) {
  StatusFacts facts;
  facts.sensors = {{SensorId("a"), {StatusWord::kUnknown, "", ""}, DriftIn(9)},
                   {SensorId("b"), {StatusWord::kDrifted, "b moved", ""}, DriftIn(4)},
                   {SensorId("c"), {StatusWord::kOutOfTolerance, "c moved", ""}, {}}};
  EXPECT_EQ(FoundOf(facts).why, "c moved");
  EXPECT_EQ(DriftDueOf(facts), DriftIn(4));
  EXPECT_EQ(FoundOf({}), CalibrationStatus{});
}

}  // namespace
}  // namespace rigcal
