// A backup is complete or not there, and has whatever had a receipt when it began.
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include <random>

#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kFiles = 6;

class BackupTest : public UpkeepTest {};

TEST_F(BackupTest, CopiesOnlyWhatIsNew) {
  Store store = Open();
  Push(store, kFiles);
  const auto first = Back();
  ASSERT_TRUE(first) << WordsOf(first);
  EXPECT_EQ(first->label.number, 1);
  EXPECT_EQ(first->copied, static_cast<std::int64_t>(kFiles));
  EXPECT_EQ(ReadFile(KeptBlobOf(ContentOf(3)), 100).value(), ContentOf(3));
  Push(store, 2, RobotId("other"));
  const auto second = Back();
  ASSERT_TRUE(second) << WordsOf(second);
  EXPECT_EQ(second->label.number, 2);
  EXPECT_EQ(second->copied, 2);
  EXPECT_EQ(second->label.blobs, static_cast<std::int64_t>(kFiles) + 2);
  EXPECT_FALSE(fs::exists(backup() / "unfinished"));
}

TEST_F(BackupTest, KeepsTheOneBefore) {
  Store store = Open();
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(Back());
  EXPECT_THAT(ListBackups(backup()).value(), ElementsAre(3, 4));
}

TEST_F(BackupTest, TouchesNoOtherFolder) {
  Store store = Open();
  fs::create_directory(backup());
  std::ofstream(backup() / "letters") << "dear";
  EXPECT_EQ(Back().error().code, ErrorCode::kInvalidInput);
  EXPECT_THAT(MakeBackup({data(), data() / "backup"}, clock_).error().what, HasSubstr("lies in the data folder"));
  EXPECT_EQ(MakeBackup({folder_.path() / "nothing", backup()}, clock_).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(fs::exists(folder_.path() / "nothing"));
}

TEST_F(BackupTest, NamesWhatIsLostUnlessAnEarlierOneHasIt) {
  Store store = Open();
  const SessionId session = Push(store, kFiles);
  fs::remove(BlobOf(ContentOf(2)));
  FlipByte(BlobOf(ContentOf(4)), 1);
  const auto without = Back();
  ASSERT_TRUE(without) << WordsOf(without);
  ASSERT_EQ(without->lost.size(), 2U);
  for (const std::string& one : without->lost)
    EXPECT_THAT(one, HasSubstr("of session " + session.str().substr(0, 16) + " of robot mapper-01"));
  EXPECT_EQ(without->label.lacking, 2);
  EXPECT_FALSE(fs::exists(KeptBlobOf(ContentOf(4)))) << "a damaged file is not copied";

  fs::remove(BlobOf(ContentOf(4)));
  for (const std::size_t idx : {2, 4}) ASSERT_TRUE(AppendBlob(store.BlobFolder(), ContentOf(idx)));
  ASSERT_TRUE(Back()->lost.empty());
  FlipByte(BlobOf(ContentOf(2)), 1);
  EXPECT_TRUE(Back()->lost.empty());
  EXPECT_EQ(ReadFile(KeptBlobOf(ContentOf(2)), 100).value(), ContentOf(2));
}

TEST_F(BackupTest, TrustsNoFileOfOneThatWasBrokenOff) {
  Store store = Open();
  Push(store, kFiles);
  ASSERT_TRUE(Back());
  FlipByte(KeptBlobOf(ContentOf(0)), 2);
  EXPECT_EQ(Back()->copied, 0) << "nobody asked for it";
  EXPECT_EQ(Back(true)->copied, 1);
  FlipByte(KeptBlobOf(ContentOf(0)), 2);
  std::ofstream(backup() / "unfinished");
  std::ofstream(KeptBlobOf(ContentOf(1)).string() + ".tmp-1") << "half";
  EXPECT_EQ(Back()->copied, 1);
  EXPECT_EQ(ReadFile(KeptBlobOf(ContentOf(0)), 100).value(), ContentOf(0));
  EXPECT_FALSE(fs::exists(KeptBlobOf(ContentOf(1)).string() + ".tmp-1"));
}

TEST_F(BackupTest, MakesNoneOfADamagedDatabase) {
  {
    Store store = Open();
    Push(store, kFiles);
  }
  ASSERT_TRUE(Back());
  // Within a value: SQLite itself sees nothing of it.
  FlipByte(data() / "rigcal.db",
           static_cast<std::int64_t>(ReadFile(data() / "rigcal.db", 1 << 24)->find("\"payloads\":6")) + 2);
  const auto refused = Back();
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("is damaged at page "));
  EXPECT_THAT(ListBackups(backup()).value(), ElementsAre(1));
}

TEST_F(BackupTest, LinksWhereAsked) {
  Store store = Open();
  Push(store, kFiles);
  const auto done = MakeBackup({data(), backup(), CopyHow::kLink}, clock_);
  ASSERT_TRUE(done) << WordsOf(done);
  EXPECT_EQ(done->copied_bytes, 0);
  EXPECT_EQ(fs::hard_link_count(BlobOf(ContentOf(0))), 2U);
}

TEST_F(BackupTest, OneAtATime) {
  Store store = Open();
  const auto other = BackupFolder::Open(backup());
  ASSERT_TRUE(other) << WordsOf(other);
  EXPECT_EQ(Back().error().code, ErrorCode::kConflict);
}

// kill -9 at random moments: the last complete backup can always be restored, and the next one goes on.
TEST_F(BackupTest, KilledItLeavesTheLastOne) {
  constexpr int kRounds = 15;
  Store store = Open();
  Push(store, 40);
  ASSERT_TRUE(Back());
  std::mt19937 random(20261126);
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE(round);
    Push(store, 40, RobotId("robot-" + std::to_string(round)));
    const pid_t child = fork();
    if (child == 0) _exit(MakeBackup({data(), backup()}, clock_) ? 0 : 1);
    poll(nullptr, 0, std::uniform_int_distribution<int>(0, 30)(random));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const fs::path to = folder_.path() / ("restored-" + std::to_string(round));
    const auto restored = RestoreBackup({backup(), to});
    ASSERT_TRUE(restored) << WordsOf(restored);
    EXPECT_TRUE(restored->lost.empty());
    EXPECT_EQ(Fsck({to}, clock_)->unmended(), 0);
  }
  const auto last = Back();
  ASSERT_TRUE(last) << WordsOf(last);
  EXPECT_EQ(last->label.blobs, 40 * (kRounds + 1));
}

}  // namespace
}  // namespace rigcal::storage
