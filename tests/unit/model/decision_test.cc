// Who approves what, and how it is told where a revision is in its life.
#include "server/model/approval/decision.h"

#include <gtest/gtest.h>

namespace rigcal {
namespace {

constexpr Stamp kNoon{1'793'707'200'000'000'000};  // 3 Nov 2026

Verdict Of(VerdictLevel level) { return {level, "", ""}; }

TEST(Decision, ThePolicyApprovesWhatPassesAndWarnsUnlessItSaysOtherwise) {
  Policy policy;
  EXPECT_TRUE(Approves(policy, Of(VerdictLevel::kPass)));
  EXPECT_TRUE(Approves(policy, Of(VerdictLevel::kPass), true));
  policy.approve_drift = false;
  EXPECT_FALSE(Approves(policy, Of(VerdictLevel::kPass), true));
  EXPECT_TRUE(Approves(policy, Of(VerdictLevel::kWarn)));
  policy.approve_warnings = false;
  EXPECT_TRUE(Approves(policy, Of(VerdictLevel::kPass)));
  EXPECT_FALSE(Approves(policy, Of(VerdictLevel::kWarn)));
  policy.approval = ApprovalBy::kPerson;
  policy.approve_warnings = true;
  for (const VerdictLevel level : {VerdictLevel::kPass, VerdictLevel::kWarn}) EXPECT_FALSE(Approves(policy, Of(level)));
  policy.approval = ApprovalBy::kAutomatic;
  for (const VerdictLevel level : {VerdictLevel::kFail, VerdictLevel::kUnknown})
    EXPECT_FALSE(Approves(policy, Of(level)));
}

TEST(Decision, StatesHaveNames) {
  for (const RevisionState state :
       {RevisionState::kUnusable, RevisionState::kCandidate, RevisionState::kApproved, RevisionState::kTakenBack,
        RevisionState::kSuperseded, RevisionState::kRolledBack, RevisionState::kRejected})
    EXPECT_EQ(RevisionStateOf(NameOf(state)), state);
  EXPECT_EQ(RevisionStateOf("of a newer version"), RevisionState::kUnusable);
  EXPECT_EQ(WordFor(RevisionState::kApproved), "in use");
  EXPECT_EQ(WordFor(RevisionState::kTakenBack), "taken back");
  EXPECT_EQ(WordFor(RevisionState::kRolledBack), "rolled back");
}

TEST(Decision, NobodyPosesAsThePolicyOrTheServer) {
  for (const char* name : {"policy", "Policy", " policy", "POLICY.", "rigcald"}) {
    const Status checked = CheckPerson(name);
    ASSERT_FALSE(checked) << name;
    EXPECT_EQ(checked.error().code, ErrorCode::kInvalidInput);
  }
  for (const char* name : {"Ada", "policy office",
                           "\xC3\x84"
                           "da"})
    EXPECT_TRUE(CheckPerson(name)) << name;
}

TEST(Decision, OfACandidateApprovingItComesFirst) {
  const RobotId rig("rig");
  const Verdict warns{VerdictLevel::kWarn, "", "Capture top."}, passes{VerdictLevel::kPass, "", "Nothing; it is well."};
  EXPECT_EQ(WhatToDo(rig, 4, RevisionState::kCandidate, passes),
            "`rigcal approve rig 4 --reason TEXT`, if it is right.");
  EXPECT_EQ(WhatToDo(rig, 4, RevisionState::kCandidate, warns),
            "`rigcal approve rig 4 --reason TEXT`, if it is right; then: Capture top.");
  EXPECT_EQ(WhatToDo(rig, 4, RevisionState::kApproved, passes), "Nothing; it is well.");
}

TEST(Decision, WhatIsInUseIsToldWhereItIsAnother) {
  const RobotId rig("rig");
  const Decision third{7, 3, "approved", {kNoon, "policy", "the verdict is pass"}};
  EXPECT_EQ(ApprovalText(rig, 3, {RevisionState::kApproved, third, third}), "");
  EXPECT_EQ(ApprovalText(rig, 5, {RevisionState::kUnusable, {}, third}), "") << "the verdict says what to keep";
  EXPECT_EQ(ApprovalText(rig, 4, {RevisionState::kCandidate, {}, third}),
            "In use: revision 3 (approved by policy, 3 Nov 2026); this one is a candidate: `rigcal approve rig 4 "
            "--reason TEXT`");
  EXPECT_EQ(ApprovalText(rig, 1, {RevisionState::kCandidate, {}, {}}),
            "No calibration of rig is in use; this one is a candidate: `rigcal approve rig 1 --reason TEXT`");
  const Decision back{9, 2, "rolled_back", {kNoon, "Ada", "bent"}};
  EXPECT_EQ(ApprovalText(rig, 3, {RevisionState::kRolledBack, third, back}),
            "In use: revision 2 (rolled back to by Ada, 3 Nov 2026); this one was rolled back");
  const Decision no{9, 4, "rejected", {kNoon, "Ada", "bent"}};
  EXPECT_EQ(ApprovalText(rig, 4, {RevisionState::kRejected, no, third}),
            "In use: revision 3 (approved by policy, 3 Nov 2026); this one was rejected by Ada, 3 Nov 2026: bent");
}

}  // namespace
}  // namespace rigcal
