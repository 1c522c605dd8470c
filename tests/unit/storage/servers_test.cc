// Several servers on one store: which are there, what each is to tell, and what each has of the folder for itself.
#include "storage/work/servers.h"

#include <gmock/gmock.h>

#include <thread>

#include "storage/files/folder_lock.h"
#include "storage/migrate.h"
#include "storage/postgres/postgres_link.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

class ServersTest : public StoreTest {
 protected:
  Status Announce(const std::string& subject, const std::string& sender = {}) {
    return AppendAnnouncement(store_, {kRobot, "edge", subject, "{}", {7}}, sender);
  }
  std::string Told(const std::string& server) {
    std::string subjects;
    for (const WaitingAnnouncement& one : TakeAnnouncements(other_, server).value()) subjects += one.subject + " ";
    return subjects;
  }

  Store other_ = Open();
};

TEST_F(ServersTest, EachOfThemIsToldOnceButForTheSender) {
  ASSERT_TRUE(Announce("before")) << "nobody is there";
  for (const char* name : {"a", "b"}) ASSERT_TRUE(AppendServer(store_, {name, {}}));
  ASSERT_TRUE(Announce("first"));
  ASSERT_TRUE(Announce("second", "a"));
  EXPECT_EQ(Told("a"), "first ");
  EXPECT_EQ(Told("b"), "first second ");
  EXPECT_EQ(Told("a") + Told("b"), "");
  ASSERT_TRUE(AppendAnnouncement(store_, {kRobot, "", "", "", {8}}, "b"));
  const auto taken = TakeAnnouncements(other_, "a").value();
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].at.ns, 8);
  EXPECT_EQ(taken[0].kind, "");
}

TEST_F(ServersTest, OneThatIsGoneKeepsNothingWaiting) {
  for (const char* name : {"ended", "killed", "here"})
    ASSERT_TRUE(AppendServer(store_, {name, {"http://h/" + RobotId(name).str()}}));
  ASSERT_TRUE(Announce("first"));
  ASSERT_TRUE(RemoveServer(store_, "ended"));
  EXPECT_TRUE(RenewServer(store_, "killed", 0ms).value());
  ASSERT_TRUE(Announce("second"));
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM waiting_announcement WHERE server = 'ended'"), 0);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM waiting_announcement WHERE server = 'killed'"), 1) << "only the first";
  ASSERT_TRUE(AppendServer(store_, {"here", {}}));
  EXPECT_EQ(Told("here"), "first second ") << "whoever starts again has what waits for it";
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM waiting_announcement"), 0);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM lease_receiver"), 0);
  EXPECT_FALSE(RenewServer(store_, "killed").value()) << "it is to be listed anew";
  EXPECT_TRUE(RenewServer(store_, "here").value());
}

TEST_F(ServersTest, ToBeListedWaitsForNobodysWrite) {
  if (IsOnSqlite()) GTEST_SKIP() << "one process has a store on SQLite";
  ASSERT_TRUE(AppendServer(store_, {"a", {}}));
  EXPECT_TRUE(other_.Write([&] { return RenewServer(store_, "a").map([](bool) {}); }));
}

TEST(SharedFolder, EachServerHasAPartOfTheIntake) {
  const TempFolder folder;
  const fs::path intake = folder.path() / "intake", old = intake / std::string(64, 'a');
  fs::create_directories(old);
  EXPECT_EQ(ShareFolder(folder.path(), "pc").value(), "pc-1");
  EXPECT_FALSE(fs::exists(old)) << "an older version left it";
  EXPECT_EQ(ShareFolder(folder.path(), "pc").value(), "pc-2");
  EXPECT_EQ(ShareFolder(folder.path(), "laptop").value(), "laptop-1");
  const Status alone = LockFolder(folder.path());
  ASSERT_FALSE(alone);
  EXPECT_THAT(alone.error().what, HasSubstr("another rigcald uses the data folder"));
  const TempFolder locked;
  ASSERT_TRUE(LockFolder(locked.path()));
  EXPECT_FALSE(ShareFolder(locked.path(), "pc"));
}

// The second one knew the version of before, and waits while the first one brings the tables forward.
TEST_F(ServersTest, TwoThatBeginAtOnceMigrateOnce) {
  if (IsOnSqlite()) GTEST_SKIP() << "one process has a store on SQLite";
  PostgresLink first(place().server);
  const auto note = [&](int version) {
    first.Execute("UPDATE rigcal.schema_version SET version = " + std::to_string(version));
  };
  note(NewestSchemaVersion() - 1);
  first.Execute("BEGIN; SELECT pg_advisory_xact_lock(125797031698796)");
  note(NewestSchemaVersion());
  std::string said;
  std::thread second([&] { said = WordsOf(Store::Open(place())); });
  const auto until = std::chrono::steady_clock::now() + 60s;
  const auto waits = [&] {
    return IntIn(other_, "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND NOT granted") > 0;
  };
  while (!waits() && std::chrono::steady_clock::now() < until) continue;
  first.Execute("COMMIT");
  second.join();
  EXPECT_EQ(said, "good");
}

}  // namespace
}  // namespace rigcal::storage
