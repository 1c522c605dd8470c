// The life of a calibration in the store: which revision is in use, after whatever was decided.
#include "storage/revisions/decisions.h"

#include <gmock/gmock.h>

#include "storage/audit.h"
#include "storage/sessions/retired.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using State = RevisionState;

class DecisionsTest : public StoreTest {
 protected:
  // Each with a document of its own.
  void AppendRevisions(const std::vector<VerdictLevel>& levels) {
    for (const VerdictLevel level : levels) AppendWith("document " + std::to_string(++documents_), level);
  }
  void AppendWith(const std::string& document, VerdictLevel level = VerdictLevel::kPass) {
    Revision revision = MakeRevision(1);
    revision.verdict.level = level;
    revision.document = document;
    revision.digest = DigestOf(document);
    ASSERT_TRUE(AppendRevision(store_, revision));
  }
  void AppendGood(int count) {
    AppendRevisions(std::vector<VerdictLevel>(static_cast<std::size_t>(count), VerdictLevel::kPass));
  }
  Result<bool> Decide(Deciding deciding, int revision) {
    return AppendDecision(store_, kRobot, revision, deciding, {{++now_}, "Ada", "because"});
  }
  void Approve(int revision) { EXPECT_TRUE(Decide(Deciding::kApprove, revision).value_or(false)) << revision; }
  void Reject(int revision) { EXPECT_TRUE(Decide(Deciding::kReject, revision).value_or(false)) << revision; }
  void RollBack(int revision) { EXPECT_TRUE(Decide(Deciding::kRollBack, revision).value_or(false)) << revision; }
  int InUse() {
    const auto in_use = LoadInUse(store_, kRobot).value();
    const auto usable = LoadUsableRevision(store_, kRobot).value();
    EXPECT_EQ(in_use.has_value(), usable.has_value());
    if (in_use && usable) {
      EXPECT_EQ(in_use->revision, usable->number);
    }
    return in_use ? in_use->revision : 0;
  }
  std::optional<UsableRevision> Usable() {
    const auto usable = LoadUsableRevision(store_, kRobot).value();
    return usable ? std::optional(UsableRevision{usable->number, usable->created_at}) : std::nullopt;
  }
  std::vector<State> States() {
    std::vector<State> states;
    const std::vector<Revision> revisions = LoadRevisions(store_, kRobot).value();
    for (const Revision& revision : revisions)
      states.insert(states.begin(), LoadRevisionState(store_, revision, Usable()).value());
    return states;
  }

  std::int64_t now_ = 100;
  int documents_ = 0;
};

TEST_F(DecisionsTest, NothingIsInUseThatNobodyApproved) {
  AppendRevisions({VerdictLevel::kPass, VerdictLevel::kFail, VerdictLevel::kWarn});
  EXPECT_EQ(InUse(), 0);
  EXPECT_EQ(LoadNewestApproved(store_, kRobot).value(), 0);
  EXPECT_THAT(States(), ElementsAre(State::kCandidate, State::kUnusable, State::kCandidate));
  Approve(1);
  EXPECT_EQ(InUse(), 1);
  Approve(3);
  EXPECT_EQ(InUse(), 3);
  EXPECT_THAT(States(), ElementsAre(State::kSuperseded, State::kUnusable, State::kApproved));
  EXPECT_EQ(LoadStillUsable(store_, kRobot, 2).value()->number, 1) << "of those of before";
  EXPECT_FALSE(LoadStillUsable(store_, kRobot, 0).value());
}

TEST_F(DecisionsTest, ARollbackLeavesBehindWhatIsNewer) {
  AppendGood(4);
  for (const int revision : {1, 2, 3}) Approve(revision);
  RollBack(1);
  EXPECT_EQ(InUse(), 1);
  EXPECT_THAT(States(), ElementsAre(State::kApproved, State::kRolledBack, State::kRolledBack, State::kCandidate));
  EXPECT_EQ(LoadNewestApproved(store_, kRobot).value(), 3) << "its poses may be with readers";
  Reject(1);
  EXPECT_EQ(InUse(), 0) << "not what the robot was rolled back behind";
  RollBack(2);
  EXPECT_EQ(InUse(), 2);
  Approve(4);
  EXPECT_EQ(InUse(), 4);
  EXPECT_THAT(States(), ElementsAre(State::kRejected, State::kSuperseded, State::kRolledBack, State::kApproved));
}

TEST_F(DecisionsTest, ARejectedOneMakesWayForTheOneBefore) {
  AppendGood(2);
  Approve(1);
  Approve(2);
  Reject(2);
  EXPECT_EQ(InUse(), 1);
  EXPECT_THAT(States(), ElementsAre(State::kApproved, State::kRejected));
  Approve(2);
  EXPECT_EQ(InUse(), 2);
  EXPECT_THAT(States(), ElementsAre(State::kSuperseded, State::kApproved));
}

TEST_F(DecisionsTest, TwiceIsOnceAndTheFirstWordHolds) {
  AppendGood(1);
  Approve(1);
  EXPECT_FALSE(Decide(Deciding::kApprove, 1).value());
  EXPECT_FALSE(Decide(Deciding::kRollBack, 1).value());
  EXPECT_EQ(LoadInUse(store_, kRobot).value()->word, (Word{{101}, "Ada", "because"}));
  Reject(1);
  EXPECT_FALSE(Decide(Deciding::kReject, 1).value());
  const std::vector<AuditRow> rows = LoadAudit(store_, kRobot).value();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].what, "rejected revision 1 of robot mapper-01: because");
  EXPECT_EQ(rows[1].what, "approved revision 1 of robot mapper-01: because");
}

TEST_F(DecisionsTest, WhatCannotBeDecidedIsRefusedAndLeavesNoTrace) {
  AppendRevisions({VerdictLevel::kPass, VerdictLevel::kFail, VerdictLevel::kUnknown});
  const auto refused = [&](Deciding deciding, int revision) {
    const auto decided = Decide(deciding, revision);
    return decided ? "" : NameOf(decided.error().code) + ": " + decided.error().what;
  };
  EXPECT_EQ(refused(Deciding::kApprove, 2),
            "conflict: revision 2 of robot mapper-01 has the verdict fail: only pass and warn are used");
  EXPECT_EQ(refused(Deciding::kApprove, 3),
            "conflict: revision 3 of robot mapper-01 has the verdict unknown: only pass and warn are used");
  EXPECT_EQ(refused(Deciding::kRollBack, 1),
            "conflict: revision 1 of robot mapper-01 was never approved: there is nothing to go back to");
  for (const int none : {0, 4, -1})
    EXPECT_EQ(refused(Deciding::kReject, none), "not_found: robot 'mapper-01' has no revision " + std::to_string(none));
  EXPECT_FALSE(AppendDecision(store_, kRobot, 1, Deciding::kApprove, {{1}, "A\nda", ""}));
  EXPECT_TRUE(LoadAudit(store_, RobotId())->empty());
  EXPECT_EQ(InUse(), 0);
}

// Nobody decided that the one before it is in use again.
TEST_F(DecisionsTest, WhatCountsARetiredEdgeIsTakenBackAndNothingIsInUse) {
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(1)));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));
  ASSERT_TRUE(AppendRevision(store_, MakeRevision(2)));
  Approve(1);
  Approve(2);
  ASSERT_TRUE(RetireEdge(store_, MakeEdge(2).id, {{5}, "Ada", "typed wrong"}));
  EXPECT_EQ(LoadInUse(store_, kRobot).value()->revision, 2);
  EXPECT_FALSE(LoadUsableRevision(store_, kRobot).value());
  EXPECT_EQ(LoadStillUsable(store_, kRobot).value()->number, 1) << "it could take its place";
  EXPECT_THAT(States(), ElementsAre(State::kSuperseded, State::kTakenBack));
  ASSERT_TRUE(RestoreEdge(store_, MakeEdge(2).id, {{6}, "Ada", ""}));
  EXPECT_EQ(InUse(), 2);
  EXPECT_THAT(States(), ElementsAre(State::kSuperseded, State::kApproved));
}

// A person's no holds until something is measured.
TEST_F(DecisionsTest, ThePolicyIsHeldBackUntilAnEdgeBeganToCount) {
  const Digest another(std::string(64, 'd'));
  const auto held_back = [&](const Digest& digest, std::int64_t edges) {
    return IsHeldBack(store_, kRobot, digest, edges).value();
  };
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(1), {1}));
  AppendGood(2);
  const Digest made = LoadRevisionSummary(store_, kRobot, 2).value()->digest;
  EXPECT_FALSE(held_back(made, 1));
  Approve(1);
  Approve(2);
  EXPECT_FALSE(held_back(another, 1)) << "a yes holds nobody back";
  RollBack(1);
  EXPECT_TRUE(held_back(another, 1));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));
  EXPECT_FALSE(held_back(another, 2));
  Reject(2);
  EXPECT_TRUE(held_back(another, 2));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(3), {1}));
  EXPECT_FALSE(held_back(another, 3));
  EXPECT_TRUE(held_back(made, 3)) << "the document of a rejected revision";
  Approve(2);
  EXPECT_FALSE(held_back(made, 3));
}

TEST_F(DecisionsTest, NobodyGoesBackToWhatWasRejected) {
  AppendGood(2);
  Approve(1);
  Approve(2);
  Reject(1);
  const auto refused = Decide(Deciding::kRollBack, 1);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  EXPECT_EQ(refused.error().what,
            "revision 1 of robot mapper-01 was rejected by Ada, 1 Jan 1970: nobody goes back to it before somebody "
            "approves it");
  EXPECT_EQ(InUse(), 2);
  Approve(1);
  EXPECT_EQ(InUse(), 1);
}

// An epoch that was begun and taken back leaves the same calibration twice.
TEST_F(DecisionsTest, WhoRejectsACalibrationRejectsAllThatAreTheSame) {
  for (const char* document : {"oldest", "bent", "bent"}) AppendWith(document);
  Approve(2);
  Approve(3);
  Reject(3);
  EXPECT_EQ(InUse(), 0) << "not the very same poses";
  EXPECT_THAT(States(), ElementsAre(State::kCandidate, State::kRejected, State::kRejected));
  EXPECT_EQ(LoadDecision(store_, kRobot, 2).value()->revision, 3) << "by which it is rejected";
  EXPECT_EQ(LoadStillUsable(store_, kRobot, 2, {now_ - 1}).value()->number, 2) << "before that";
  const auto refused = Decide(Deciding::kRollBack, 2);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().what,
            "revision 2 of robot mapper-01 is the same calibration as revision 3, which was rejected by Ada, 1 Jan "
            "1970: nobody goes back to it before somebody approves it");
  Approve(2);
  EXPECT_EQ(InUse(), 2) << "a later word holds";
}

TEST_F(DecisionsTest, ANewNoToACopyIsNoRepetition) {
  for (const char* document : {"bent", "bent"}) AppendWith(document);
  Approve(1);
  Reject(2);
  EXPECT_FALSE(Decide(Deciding::kReject, 2).value());
  Approve(1);
  Reject(2);
  EXPECT_EQ(InUse(), 0);
  EXPECT_THAT(States(), ElementsAre(State::kRejected, State::kRejected));
}

// Nobody is asked to approve it, whether it was there before the word or came after it.
TEST_F(DecisionsTest, ACopyThatNobodyDecidedAboutIsRejectedWithTheOther) {
  for (const char* document : {"bent", "bent", "straight"}) AppendWith(document);
  Reject(2);
  AppendWith("bent");
  EXPECT_THAT(States(), ElementsAre(State::kRejected, State::kRejected, State::kCandidate, State::kRejected));
  EXPECT_EQ(LoadDecision(store_, kRobot, 4).value()->revision, 2);
  EXPECT_FALSE(LoadDecision(store_, kRobot, 3).value());
  const auto refused = Decide(Deciding::kRollBack, 1);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("is the same calibration as revision 2, which was rejected by Ada"));
  Approve(4);
  EXPECT_EQ(InUse(), 4) << "a later word holds";
}

TEST_F(DecisionsTest, ARejectedCopyMakesWayForTheOneBeforeTheOriginal) {
  for (const char* document : {"straight", "bent", "bent"}) AppendWith(document);
  Approve(1);
  Approve(2);
  Reject(3);  // a candidate
  EXPECT_EQ(InUse(), 1);
  EXPECT_THAT(States(), ElementsAre(State::kApproved, State::kRejected, State::kRejected));
}

// Version 22: what passed or warned was announced; the newest of these is in use.
TEST(DecisionsMigration, WhatWasAnnouncedIsApproved) {
  const TempFolder folder;
  std::string sql = EmptyStoreOfVersion(22);
  sql +=
      "INSERT INTO robot VALUES ('mapper-01', 1), ('b', "
      "1);";
  const std::vector<std::string> verdicts = {"pass", "warn", "fail"};
  for (std::size_t i = 0; i < verdicts.size(); ++i)
    sql += "INSERT INTO revision VALUES ('mapper-01', " + std::to_string(i + 1) + ", 5, 0, '" + verdicts[i] +
           "', 'why', 'do', '" + std::string(64, 'a') + "', '{}');";
  sql += "INSERT INTO revision VALUES ('b', 1, 5, 0, 'fail', 'why', 'do', '" + std::string(64, 'a') + "', '{}');";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  const auto in_use = LoadInUse(*store, kRobot).value();
  ASSERT_TRUE(in_use);
  EXPECT_EQ(in_use->revision, 2);
  EXPECT_EQ(in_use->word.who, kPolicyWho);
  EXPECT_EQ(LoadUsableRevision(*store, kRobot).value()->number, 2);
  EXPECT_EQ(LoadRevisionState(*store, LoadRevisionSummary(*store, kRobot, 1)->value(), UsableRevision{2, {}}).value(),
            State::kSuperseded);
  EXPECT_FALSE(LoadInUse(*store, RobotId("b")).value());
  EXPECT_TRUE(AppendDecision(*store, kRobot, 1, Deciding::kRollBack, {{9}, "Ada", "back"}).value());
  EXPECT_EQ(LoadInUse(*store, kRobot).value()->revision, 1);
}

}  // namespace
}  // namespace rigcal::storage
