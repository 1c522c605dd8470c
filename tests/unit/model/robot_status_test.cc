// The one word of a robot's status, case by case, and the dates beside it.
#include "server/model/robots/robot_status.h"

#include <gtest/gtest.h>

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
