// What may be driven, for each verdict before and after its calibration is overdue.
#include "server/model/robots/drive_rule.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

const Stamp kDue = *ParseIso("2027-02-20T08:00:00Z");
const Stamp kBefore{kDue.ns - 1}, kAfter{kDue.ns + 1};

Verdict VerdictOf(VerdictLevel level, const std::string& what_to_do = "") { return {level, "So it is.", what_to_do}; }

TEST(DriveRule, APassHoldsUntilItIsDue) {
  for (const Stamp now : {kBefore, kDue}) {
    const DriveRule rule = DriveRuleOf(VerdictOf(VerdictLevel::kPass), kDue, now);
    EXPECT_EQ(rule.rule, "OK to drive until 20 Feb 2027");
    EXPECT_EQ(rule.until, kDue);
    EXPECT_EQ(rule.level, VerdictLevel::kPass);
  }
}

TEST(DriveRule, WhatIsOverdueIsNoPass) {
  for (const VerdictLevel level : {VerdictLevel::kPass, VerdictLevel::kWarn}) {
    const DriveRule rule = DriveRuleOf(VerdictOf(level, "Capture top."), kDue, kAfter);
    EXPECT_EQ(rule.rule, "Not verified: do not rely on it, overdue since 20 Feb 2027; capture again");
    EXPECT_FALSE(rule.until);
    EXPECT_EQ(rule.level, VerdictLevel::kUnknown) << "issue 21: this sentence is that of what is not known";
    EXPECT_EQ(rule.kind, DriveKind::kNotVerified);
  }
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), std::nullopt, kBefore).level, VerdictLevel::kUnknown);
}

TEST(DriveRule, AWarningSaysTheFirstThingToDoAndByWhen) {
  const auto rule = [](const std::string& what_to_do) {
    return DriveRuleOf(VerdictOf(VerdictLevel::kWarn, what_to_do), kDue, kBefore);
  };
  EXPECT_EQ(rule("Capture top at more distances and tilts.").rule,
            "OK to drive; capture top at more distances and tilts by 20 Feb 2027");
  EXPECT_EQ(rule("Capture top; then capture left.").rule, "OK to drive; capture top by 20 Feb 2027");
  EXPECT_EQ(rule("Take more. Tilt it.").rule, "OK to drive; take more by 20 Feb 2027");
  EXPECT_EQ(rule("Try `model: fisheye_kb4` for left.").rule,
            "OK to drive; try `model: fisheye_kb4` for left by 20 Feb 2027")
      << "a colon within a command is no part of the sentence";
  EXPECT_EQ(rule("Check its mount, then `rigcal push FOLDER`.").rule, "OK to drive; check its mount by 20 Feb 2027");
  EXPECT_EQ(rule("Was left moved? Yes: `rigcal push FOLDER --remounted left`. No: capture it again.").rule,
            "OK to drive; answer what the verdict asks by 20 Feb 2027");
  EXPECT_EQ(rule("").rule, "OK to drive until 20 Feb 2027");
  EXPECT_EQ(rule("").until, kDue);
  EXPECT_EQ(rule("").level, VerdictLevel::kWarn);
}

TEST(DriveRule, ASentenceIsNeverCutAtPunctuationWithinIt) {
  const auto rule = [](const std::string& what_to_do) {
    return DriveRuleOf(VerdictOf(VerdictLevel::kWarn, what_to_do), kDue, kBefore).rule;
  };
  EXPECT_EQ(rule("Allow a larger bump: one below 1 mm is not told."),
            "OK to drive; allow a larger bump: one below 1 mm is not told, by 20 Feb 2027");
  EXPECT_EQ(rule("Calibrate one more pair, or repeat a pair, so that edges check each other; then do more."),
            "OK to drive; calibrate one more pair, or repeat a pair, so that edges check each other, by 20 Feb 2027");
}

TEST(DriveRule, OfAFailAndOfWhatIsNotKnownTimeChangesNothing) {
  Verdict unknown = VerdictOf(VerdictLevel::kUnknown);
  for (const Stamp now : {kBefore, kAfter}) {
    EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kFail), kDue, now).rule, "Do not drive");
    EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kFail), kDue, now).level, VerdictLevel::kFail);
    EXPECT_EQ(DriveRuleOf(unknown, kDue, now).rule, "Not verified: do not rely on this calibration");
  }
  unknown.unverified = "lidar and arm";
  const DriveRule rule = DriveRuleOf(unknown, std::nullopt, kBefore);
  EXPECT_EQ(rule.rule, "Not verified: do not rely on lidar and arm");
  EXPECT_EQ(rule.level, VerdictLevel::kUnknown);
  EXPECT_FALSE(rule.until);
}

TEST(DriveRule, OfAValidityAsOfWhenItWasWorkedOut) {
  Validity validity;
  validity.calibrated_at = Stamp{kDue.ns - 30};
  validity.max_age_ns = 30;
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).until, kDue);
  validity.superseded_by = 7;
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).rule,
            "Superseded by revision 7: what this one says of driving is past");
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).level, VerdictLevel::kUnknown);
  validity.superseded_by.reset();
  validity.approved = false;
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).rule,
            "Not approved: do not rely on it before somebody approves it");
  validity.usable = UsableRevision{3, kBefore};
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).rule, "Not approved: robots have revision 3");
  validity.usable->calibrated_at = *ParseIso("2026-07-01T08:00:00Z");
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).rule,
            "Not approved: robots have revision 3, measured 1 Jul 2026, valid until 29 Sep 2026")
      << "not when it was solved";
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).level, VerdictLevel::kUnknown);
  validity.approved = true;
  validity.overdue = true;
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).rule,
            "Not verified: do not rely on it, overdue since 20 Feb 2027; capture again");
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kFail), validity).rule, "Do not drive");
}

TEST(DriveRule, WhatTheRobotDoesNotRunIsNotOkToDriveBy) {
  Validity validity;
  validity.calibrated_at = Stamp{kDue.ns - 30};
  validity.max_age_ns = 30;
  validity.usable = UsableRevision{2, kBefore};
  const Runs older{1, "It runs revision 1; revision 2 is in use: not applied yet.", "revision 1"};
  const DriveRule rule = DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity, older);
  EXPECT_EQ(rule.rule, "Not applied: the robot runs revision 1; revision 2 is in use");
  EXPECT_EQ(rule.kind, DriveKind::kNotApplied);
  EXPECT_EQ(rule.level, VerdictLevel::kUnknown);
  EXPECT_FALSE(rule.until);
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kFail), validity, older).rule, "Do not drive");
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity, Runs{2, "", "revision 2"}).kind, DriveKind::kOk);
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).kind, DriveKind::kOk) << "it never told";
  validity.usable.reset();
  validity.approved = false;
  EXPECT_EQ(DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity).kind, DriveKind::kToApprove);
  const Runs rejected{1, "It runs ...", "revision 1, which was rejected by Ada, 3 Nov 2026"};
  EXPECT_EQ(
      DriveRuleOf(VerdictOf(VerdictLevel::kPass), validity, rejected).rule,
      "Do not rely on it: the robot runs revision 1, which was rejected by Ada, 3 Nov 2026, and no calibration of "
      "it is in use");
}

TEST(DriveRule, KindsHaveNames) {
  for (const DriveKind kind : kDriveKinds) EXPECT_EQ(DriveKindOf(NameOf(kind)), kind);
  EXPECT_FALSE(DriveKindOf("of a newer server"));
  EXPECT_EQ(WordsFor(DriveKind::kToApprove), "to be approved");
}

}  // namespace
}  // namespace rigcal
