// Alerts wait for each receiver until it has them, in the order of their robot; and the status as SQL has it is that of
// the model.
#include "storage/alerts/outbox.h"

#include <gmock/gmock.h>

#include "storage/fleet/fleet_list.h"
#include "storage/fleet/robot_status.h"
#include "storage/fleet/robot_summary.h"
#include "storage/work/servers.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;

constexpr Stamp kNow{20'000 * kDay_ns};
const std::string kUrl = "http://localhost/a?token=x", kOther = "http://localhost/b";
const RobotId kSecond("second");

class OutboxTest : public StoreTest {
 protected:
  void Happen(const RobotId& robot, StatusWord word) {
    ASSERT_TRUE(AppendAlert(store_, formats::StatusAlert(robot, 1, StatusWord::kOk, {word, "why", "next"}, kNow)));
  }
  std::int64_t Next(const std::string& url = kUrl, Stamp now = kNow) {
    const auto next = LoadNextAlert(store_, url, now).value();
    return next ? next->alert.number : 0;
  }
};

TEST_F(OutboxTest, WhoWasThereWhenItHappenedIsTold) {
  Happen(kRobot, StatusWord::kDue);
  EXPECT_EQ(Next(), 0) << "nobody was there";
  ASSERT_TRUE(SetReceivers(store_, {kUrl, kOther}, kNow));
  Happen(kRobot, StatusWord::kOverdue);
  EXPECT_EQ(Next(kUrl), 2);
  EXPECT_EQ(Next(kOther), 2);
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  Happen(kRobot, StatusWord::kOk);
  const auto receivers = LoadReceivers(store_).value();
  ASSERT_EQ(receivers.size(), 2u);
  EXPECT_EQ(receivers[0].url, "http://localhost/a") << "its secret is not shown";
  EXPECT_EQ(receivers[0].waiting, 2);
  EXPECT_FALSE(receivers[1].is_told);
  EXPECT_EQ(receivers[1].waiting, 1) << "what waits waits on";
}

TEST_F(OutboxTest, ReceiversOfOtherServersAreToldAsLongAsThoseAreThere) {
  ASSERT_TRUE(AppendServer(store_, {"a", {kUrl}}));
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  ASSERT_TRUE(AppendServer(store_, {"b", {kOther}}));
  ASSERT_TRUE(SetReceivers(store_, {kOther}, kNow));
  Happen(kRobot, StatusWord::kDue);
  EXPECT_EQ(Next(kUrl), 1);
  EXPECT_EQ(Next(kOther), 1);
  ASSERT_TRUE(RemoveServer(store_, "a"));
  ASSERT_TRUE(SetReceivers(store_, {kOther}, kNow)) << "the other one starts again";
  Happen(kRobot, StatusWord::kOverdue);
  EXPECT_EQ(LoadReceivers(store_).value()[0].waiting, 1) << "what waits waits on";
  EXPECT_FALSE(LoadReceivers(store_).value()[0].is_told);
}

TEST_F(OutboxTest, OfSeveralServersOneSendsAnAlert) {
  using namespace std::chrono_literals;
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  Happen(kRobot, StatusWord::kDue);
  Happen(kRobot, StatusWord::kOverdue);
  EXPECT_TRUE(ClaimAlert(store_, kUrl, 1, 1h).value());
  EXPECT_FALSE(ClaimAlert(store_, kUrl, 1, 1h).value());
  EXPECT_EQ(Next(), 0) << "nor the one after it of the same robot";
  ASSERT_TRUE(NoteAttempt(store_, kUrl, 1, "nobody answered", kNow));
  EXPECT_EQ(Next(), 1) << "another one may try";
  EXPECT_TRUE(ClaimAlert(store_, kUrl, 1, 0ms).value());
  EXPECT_EQ(Next(), 1) << "who claimed it stood still for too long";
  EXPECT_TRUE(ClaimAlert(store_, kUrl, 1, 1h).value());
  ASSERT_TRUE(MarkDelivered(store_, kUrl, 1, 200, kNow));
  EXPECT_FALSE(ClaimAlert(store_, kUrl, 1, 1h).value()) << "it waits no more";
  EXPECT_EQ(Next(), 2);
}

TEST_F(OutboxTest, OfARobotTheOldestGoesFirstAndTheOthersWait) {
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  Happen(kRobot, StatusWord::kDue);
  Happen(kRobot, StatusWord::kOverdue);
  Happen(kSecond, StatusWord::kDue);
  ASSERT_TRUE(NoteAttempt(store_, kUrl, 1, "it answered HTTP status 400", {kNow.ns + 5}));
  EXPECT_EQ(Next(), 3) << "another robot's";
  ASSERT_TRUE(MarkDelivered(store_, kUrl, 3, 200, kNow));
  EXPECT_EQ(Next(), 0);
  EXPECT_EQ(Next(kUrl, {kNow.ns + 5}), 1);
  EXPECT_EQ(LoadReceivers(store_)->front().last_error, "it answered HTTP status 400");
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow)) << "the server starts again";
  EXPECT_EQ(Next(), 1);
  ASSERT_TRUE(MarkDelivered(store_, kUrl, 1, 204, kNow));
  ASSERT_TRUE(MarkDelivered(store_, kUrl, 1, 204, kNow)) << "once more is no more";
  EXPECT_EQ(Next(), 2);
  EXPECT_EQ(LoadReceivers(store_)->front().delivered, 2);
}

TEST_F(OutboxTest, AClockThatIsSetBackHoldsNothingUp) {
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  Happen(kRobot, StatusWord::kDue);
  ASSERT_TRUE(NoteAttempt(store_, kUrl, 1, "it answered HTTP status 400", {kNow.ns + kDay_ns}));
  EXPECT_EQ(Next(), 0) << "the longest pause";
  EXPECT_EQ(Next(kUrl, {kNow.ns - 365 * kDay_ns}), 1);
}

TEST_F(OutboxTest, WhatIsRolledBackNeverHappened) {
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  EXPECT_FALSE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendAlert(store_, formats::StatusAlert(kRobot, 1, StatusWord::kOk, {}, kNow)));
    return Fail(ErrorCode::kConflict, "no", "no");
  }));
  EXPECT_EQ(Next(), 0);
  EXPECT_FALSE(HasAlert(store_, kRobot, "status", "ok").value());
  Happen(kRobot, StatusWord::kOk);
  EXPECT_TRUE(HasAlert(store_, kRobot, "status", "ok").value());
}

// Version 29: what receivers had by then is counted once, by the migration.
TEST(OutboxMigration, WhatWasDeliveredBeforeIsCounted) {
  std::string sql = EmptyStoreBefore("0031_counts.sql");
  sql +=
      "INSERT INTO webhook VALUES (1, 'http://localhost/b', 1, 1);"
      "INSERT INTO alert VALUES (1, '" +
      std::string(64, 'a') +
      "', 'r', 'status', 'ok', 1, '{}'),"
      "(2, '" +
      std::string(64, 'b') +
      "', 'r', 'status', 'due', 2, '{}');"
      "DELETE FROM waiting_alert; INSERT INTO alert_delivered VALUES ('http://localhost/b', 1, 3, 200), "
      "('http://localhost/b', 2, 3, 200)";
  const TempFolder folder;
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_EQ(LoadReceivers(*store)->front().delivered, 2);
}

class StatusNoteTest : public StoreTest {
 protected:
  void Keep(const RobotSummary& summary) {
    ASSERT_TRUE(store_.Write([&]() -> Status {
      RIGCAL_TRY(AppendRobot(store_, summary.robot, {1}));
      RIGCAL_TRY(ReplaceSummary(store_, summary, ++changes_));
      return NoteStatus(store_, summary.robot, kNow);
    }));
  }
  std::vector<std::string> Told() {
    std::vector<std::string> told;
    while (const auto next = LoadNextAlert(store_, kUrl, {kNow.ns + 1000 * kDay_ns}).value()) {
      told.push_back(next->alert.robot.str() + " " + next->alert.subject);
      EXPECT_TRUE(MarkDelivered(store_, kUrl, next->alert.number, 200, kNow));
    }
    return told;
  }
  std::int64_t changes_ = 1000;
};

RobotSummary PassedAgo(const RobotId& robot, int days) {
  RobotSummary summary;
  summary.robot = robot;
  summary.revision = 1;
  summary.verdict = {VerdictLevel::kPass, "good", ""};
  summary.validity.calibrated_at = Stamp{kNow.ns - days * kDay_ns};
  summary.validity.usable = UsableRevision{1, {}};
  summary.state = RevisionState::kApproved;
  return summary;
}

TEST_F(StatusNoteTest, AChangeIsToldOnceAndTheFirstStatusIsNone) {
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  RobotSummary summary = PassedAgo(kRobot, 1);
  Keep(summary);
  EXPECT_THAT(Told(), ElementsAre());
  summary.found = {StatusWord::kDrifted, "left moved", "Check its mount."};
  Keep(summary);
  Keep(summary);
  EXPECT_THAT(Told(), ElementsAre(kRobot.str() + " drifted"));
  summary.validity.calculating = true;
  summary.verdict.level = VerdictLevel::kUnknown;
  Keep(summary);
  EXPECT_THAT(Told(), ElementsAre()) << "it is being worked out";
}

TEST_F(StatusNoteTest, WhatChangesWithTheTimeIsFound) {
  Keep(PassedAgo(kRobot, 1));
  EXPECT_TRUE(LoadChangedStatuses(store_, kNow, 10)->empty());
  EXPECT_THAT(LoadChangedStatuses(store_, {kNow.ns + 85 * kDay_ns}, 10).value(), ElementsAre(kRobot));
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  ASSERT_TRUE(NoteStatus(store_, kRobot, {kNow.ns + 85 * kDay_ns}));
  ASSERT_TRUE(NoteStatus(store_, kRobot, {kNow.ns + 95 * kDay_ns}));
  EXPECT_THAT(Told(), ElementsAre(kRobot.str() + " due", kRobot.str() + " overdue"));
}

TEST_F(StatusNoteTest, ThatItDoesNotRunWhatIsInUseIsToldOnceItHadTheTime) {
  ASSERT_TRUE(SetReceivers(store_, {kUrl}, kNow));
  RobotSummary summary = PassedAgo(kRobot, 1);
  Keep(summary);
  summary.runs = Runs{7,
                      "It runs revision 7; revision 1 is in use: not applied yet.",
                      "revision 7",
                      {},
                      Stamp{kNow.ns + kApplyWithin_ns}};
  Keep(summary);
  EXPECT_TRUE(LoadChangedStatuses(store_, {kNow.ns + kApplyWithin_ns - 1}, 10)->empty());
  EXPECT_THAT(Told(), ElementsAre());
  const Stamp late{kNow.ns + kApplyWithin_ns};
  EXPECT_THAT(LoadChangedStatuses(store_, late, 10).value(), ElementsAre(kRobot));
  ASSERT_TRUE(NoteStatus(store_, kRobot, late));
  EXPECT_THAT(Told(), ElementsAre(kRobot.str() + " not-applied"));
  summary.runs.reset();
  summary.state = RevisionState::kCandidate;
  summary.revision = 2;
  Keep(summary);
  EXPECT_THAT(Told(), ElementsAre(kRobot.str() + " to-approve"));
}

TEST(StatusMigration, StatusesOfBeforeAreKept) {
  const TempFolder folder;
  MakeDatabase(folder.path(), EmptyStoreBefore("0052_rollout.sql") +
                                  "INSERT INTO robot VALUES ('r', 1);"
                                  "INSERT INTO robot_status VALUES (7, 'r', 5, 'drifted', 'It moved.', 'Look.');"
                                  "DELETE FROM waiting_summary;");
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_THAT(ColumnIn(*store, "SELECT number || ' ' || status || ' ' || why FROM robot_status"),
              ElementsAre("7 drifted It moved."));
  EXPECT_EQ(LoadWaitingSummaries(*store, 9)->size(), 1u) << "the dates of lists are worked out anew";
}

// What is told of the newest revision and of what the robot runs: in use, not applied, a candidate, rejected with
// another in use, with none.
std::vector<RobotSummary> RolloutsOf(const RobotSummary& in_use) {
  std::vector<RobotSummary> all(5, in_use);
  all[1].runs = Runs{7, "It runs revision 7; revision 1 is in use: not applied yet.", "revision 7"};
  for (std::size_t i = 2; i < all.size(); ++i) all[i].validity.approved = !IsUsable(in_use.verdict);
  all[2].validity.usable = all[3].validity.usable = UsableRevision{9, {}};
  all[2].state = RevisionState::kCandidate;
  all[3].state = all[4].state = RevisionState::kRejected;
  all[4].validity.usable.reset();
  return all;
}

// Every combination, one robot each.
std::vector<RobotSummary> AllKinds() {
  std::vector<RobotSummary> all;
  for (const VerdictLevel level :
       {VerdictLevel::kPass, VerdictLevel::kWarn, VerdictLevel::kFail, VerdictLevel::kUnknown})
    for (const StatusWord found : {StatusWord::kOk, StatusWord::kDrifted, StatusWord::kOutOfTolerance})
      for (const int days : {-1, 1, 82, 83, 84, 90, 91})
        for (const int drift_days : {-1, 0, 6, 7, 8}) {
          RobotSummary summary = PassedAgo(RobotId("r"), days);
          if (days < 0) summary.validity.calibrated_at.reset();
          if (drift_days >= 0) summary.drift_due = DriftDue{SensorId("s"), {kNow.ns + drift_days * kDay_ns}};
          summary.verdict.level = level;
          summary.found.word = found;
          for (RobotSummary& one : RolloutsOf(summary)) {
            one.robot = RobotId("r" + std::to_string(all.size()));
            one.revision = all.size() % 11 == 0 ? 0 : 1;
            all.push_back(one);
          }
        }
  return all;
}

TEST_F(StatusNoteTest, AsSqlHasItItIsThatOfTheModel) {
  const std::vector<RobotSummary> all = AllKinds();
  std::map<StatusWord, std::int64_t> counted;
  ASSERT_TRUE(store_.Write([&]() -> Status {
    for (const RobotSummary& summary : all) {
      RIGCAL_TRY(AppendRobot(store_, summary.robot, {1}));
      RIGCAL_TRY(ReplaceSummary(store_, summary, 1000));
      ++counted[StatusAt(summary, kNow).word];
    }
    return {};
  }));
  const FleetCounts fleet = CountFleet(store_, kNow).value();
  for (const StatusWord word : kStatusWords) {
    EXPECT_EQ(fleet.statuses.at(word), counted[word]) << NameOf(word);
    EXPECT_GT(counted[word], 0) << NameOf(word);
    FleetQuery asked;
    asked.status = NameOf(word);
    asked.search = "good";
    EXPECT_EQ(LoadFleetPage(store_, asked, kNow)->matches, static_cast<std::size_t>(counted[word])) << NameOf(word);
  }
  FleetQuery by_status;
  by_status.sort = "status";
  const FleetPage page = LoadFleetPage(store_, by_status, kNow).value();
  EXPECT_EQ(StatusAt(page.rows.front(), kNow).word, StatusWord::kFailed);
}

}  // namespace
}  // namespace rigcal::storage
