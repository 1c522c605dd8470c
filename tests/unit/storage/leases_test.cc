// Which process works on a robot, and that one which lost it changes nothing any more.
#include "storage/work/leases.h"

#include <gmock/gmock.h>

#include "storage/audit.h"
#include "storage/postgres/postgres_link.h"
#include "storage/work/attempts.h"
#include "storage/work/servers.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class LeasesTest : public StoreTest {
 protected:
  // By somebody whose time is over as soon as it is taken.
  Lease TakeAndStandStill(const std::string& owner) { return TakeLease(store_, kRobot, owner, 0ms).value().value(); }
  Status WriteSomething() { return AppendAudit(store_, {5}, "Ada", "pushed"); }

  Store other_ = Open();
};

TEST_F(LeasesTest, OneHasARobotAtATime) {
  const auto first = TakeLease(store_, kRobot, "a").value();
  ASSERT_TRUE(first);
  EXPECT_FALSE(TakeLease(store_, kRobot, "b").value());
  EXPECT_TRUE(TakeLease(store_, RobotId("another"), "b").value());
  EXPECT_THAT(LoadLeasedByOthers(store_, "b").value(), ElementsAre(kRobot));
  EXPECT_THAT(LoadLeasedByOthers(store_, "c").value(), ElementsAre(RobotId("another"), kRobot));
  ASSERT_TRUE(GiveBackLease(store_, *first));
  const auto second = TakeLease(store_, kRobot, "b").value();
  ASSERT_TRUE(second);
  EXPECT_GT(second->token, first->token);
  EXPECT_EQ(second->lost_by, "") << "it was given back";
}

TEST_F(LeasesTest, WhoseTimeIsOverLosesItToWhoeverAsks) {
  const Lease stalled = TakeAndStandStill("a");
  EXPECT_THAT(LoadLeasedByOthers(store_, "b").value(), IsEmpty());
  const auto taken = TakeLease(store_, kRobot, "b").value();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->lost_by, "a");
  ASSERT_TRUE(GiveBackLease(store_, stalled)) << "it has nothing to give back";
  EXPECT_FALSE(TakeLease(store_, kRobot, "c").value());
}

TEST_F(LeasesTest, ARenewedOneIsKept) {
  const Lease of_last_run = TakeAndStandStill("a"), lease = TakeAndStandStill("a");
  ASSERT_TRUE(RenewLeases(store_, {of_last_run}));
  EXPECT_THAT(LoadLeasedByOthers(store_, "b").value(), IsEmpty()) << "that one was lost";
  ASSERT_TRUE(RenewLeases(store_, {lease}));
  EXPECT_FALSE(TakeLease(store_, kRobot, "b").value());
}

TEST_F(LeasesTest, ARenewalWaitsForNobodysWrite) {
  if (IsOnSqlite()) GTEST_SKIP() << "one process has a store on SQLite";
  const Lease lease = TakeAndStandStill("a");
  ASSERT_TRUE(other_.Write([&]() -> Status {
    RIGCAL_TRY(AppendAudit(other_, {5}, "Ada", "pushed"));
    return RenewLeases(store_, {lease});
  }));
  EXPECT_FALSE(TakeLease(store_, kRobot, "b").value());
}

TEST_F(LeasesTest, AWriteOfOneThatLostItChangesNothing) {
  const Lease stalled = TakeAndStandStill("a");
  {
    const Fenced fenced(store_, stalled);
    EXPECT_TRUE(WriteSomething()) << "its time is over, and nobody took it";
    ASSERT_TRUE(TakeLease(other_, kRobot, "b").value());
    const Status refused = WriteSomething();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
    EXPECT_THAT(refused.error().what,
                testing::HasSubstr("another process took over robot mapper-01 while a stood still"));
    EXPECT_FALSE(store_.Write([] { return Status{}; }));
  }
  EXPECT_TRUE(WriteSomething()) << "it is free again";
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM audit"), 2);
}

TEST_F(LeasesTest, WhatOneLeftOpenIsNotHeldAgainstTheWork) {
  const SensorPair pair{SensorId("left"), SensorId("right")};
  AppendClosedSession(store_, 2, {pair});
  const std::string work = WorkOfJob(LoadNextJob(store_, {}).value()->number), report = WorkOfReport({kRobot, 3});
  const std::string of_another = WorkOfReport({RobotId("another"), 3});
  for (const std::string& one : {work, report, of_another}) ASSERT_TRUE(BeginAttempt(store_, one, {1}));
  EXPECT_THAT(EndKilledAttempts(store_, kRobot, {2}).value(), ElementsAre(work, report));
  EXPECT_EQ(LoadAttempts(store_, work).value().cut_off, 0);
  EXPECT_TRUE(LoadAttempts(store_, of_another).value().under_way);
  ASSERT_TRUE(BeginAttempt(store_, work, {3}));
  EXPECT_THAT(EndOpenAttempts(store_, kRobot, AttemptEnd::kGivenBack, {4}).value(), ElementsAre(work));
  EXPECT_FALSE(LoadAttempts(store_, work).value().under_way);
}

TEST_F(LeasesTest, WhoListensIsToldWhatAnotherPutIntoAQueue) {
  if (IsOnSqlite()) GTEST_SKIP() << "one process has a store on SQLite";
  StoreChanges changes(store_.place(), {"waiting_announcement", "waiting_job"});
  EXPECT_THAT(changes.Await(0ms).value(), ElementsAre("waiting_announcement", "waiting_job"))
      << "nobody knows what was missed";
  EXPECT_THAT(changes.Await(0ms).value(), IsEmpty());
  ASSERT_TRUE(AppendServer(store_, {"a", {}}));
  ASSERT_TRUE(AppendAnnouncement(store_, {kRobot, "edge", "e1", "{}", {7}}));
  EXPECT_THAT(changes.Await(10s).value(), ElementsAre("waiting_announcement"));
}

TEST_F(LeasesTest, AStoreOnAServerHasOneFolder) {
  if (IsOnSqlite()) GTEST_SKIP() << "on SQLite rows and files are in one folder";
  const TempFolder another;
  const auto wrong = Store::Open({another.path(), place().server});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::kConflict);
  EXPECT_THAT(wrong.error().what,
              testing::HasSubstr("the data folder " + another.path().string() + " is not that of postgresql://"));
  const TempDatabase second(another.path());
  const auto tied = Store::Open(second.In(folder_.path()));
  ASSERT_FALSE(tied) << "the folder is the first one's";
  EXPECT_THAT(tied.error().what, testing::HasSubstr("is that of another store than"));
  std::filesystem::copy_file(folder_.path() / "store-id", another.path() / "store-id");
  EXPECT_TRUE(Store::Open({another.path(), place().server})) << "it was moved along with its files";
}

TEST_F(LeasesTest, AServerThatWasRestartedIsAskedOnceMore) {
  if (IsOnSqlite()) GTEST_SKIP() << "SQLite has no server";
  ASSERT_TRUE(WriteSomething());
  const std::string others =
      "SELECT pg_terminate_backend(pid, 10000) FROM pg_stat_activity WHERE datname = current_database() AND pid <> "
      "pg_backend_pid()";
  PostgresLink(place().server).Execute(others);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM audit"), 1) << "a question";
  PostgresLink(place().server).Execute(others);
  EXPECT_TRUE(WriteSomething()) << "a write, which has not begun";
}

TEST_F(LeasesTest, WhoIsOlderThanTheTablesWritesNoMore) {
  if (IsOnSqlite()) GTEST_SKIP() << "a store on SQLite is migrated by the one process that has it";
  PostgresLink(place().server).Execute("UPDATE rigcal.schema_version SET version = version + 1");
  const Status refused = WriteSomething();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM audit"), 0);
}

}  // namespace
}  // namespace rigcal::storage
