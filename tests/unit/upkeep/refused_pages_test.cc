// A page that the disk has changed is refused by whoever reads it, and keeps the sum by which it is found.
#include "storage/database/refused_pages.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>
#include <sys/wait.h>

#include <fstream>

#include "storage/database/summing_files.h"
#include "storage/files/lost_blobs.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;

constexpr std::size_t kFiles = 6;

class RefusedPagesTest : public UpkeepTest {
 protected:
  // Within a manifest: SQLite itself sees nothing of a byte that is changed there.
  void SetUp() override {
    {
      Store store = Open();
      session_ = Push(store, kFiles);
    }
    offset_ = static_cast<std::int64_t>(ReadFile(database(), 1 << 24)->find("\"payloads\":6")) + 2;
  }
  [[nodiscard]] fs::path database() const { return data() / "rigcal.db"; }
  [[nodiscard]] std::string PageOf() const { return "page " + std::to_string(offset_ / 4096 + 1) + " of "; }
  [[nodiscard]] std::string Refusal() const {
    return PageOf() + database().string() +
           " is not as rigcald wrote it: the disk, or another program, has changed it. Run `rigcal fsck " +
           data().string() + "`";
  }
  void ExpectFoundOnlyIn(const std::string& table, bool repair = false) {
    const auto done = Check(repair);
    ASSERT_TRUE(done) << WordsOf(done);
    const auto found = FoundOf(*done, Finding::Kind::kPage);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_THAT(found.front().what, HasSubstr(" of rigcal.db (table " + table + ")"));
    EXPECT_FALSE(found.front().is_mended);
  }
  static std::string QuickCheck(Store& store) { return store.database().execAndGet("PRAGMA quick_check").getString(); }
  SessionId session_;
  std::int64_t offset_ = 0;
};

TEST_F(RefusedPagesTest, IsNamedByWhoReadsItUntilItIsGood) {
  FlipByte(database(), offset_);
  {
    Store store = Open();
    const auto session = LoadSession(store, session_);
    ASSERT_FALSE(session);
    EXPECT_EQ(session.error().code, ErrorCode::kStorage);
    EXPECT_THAT(Sentence(session.error()), HasSubstr(Refusal()));
    EXPECT_TRUE(LoadRobot(store, kRobot).value()) << "what lies elsewhere is there";
    EXPECT_THAT(WordsOf(CheckNoneRefused(database())), HasSubstr(Refusal()));
    FlipByte(database(), offset_);
    EXPECT_TRUE(LoadSession(store, session_)) << "and the server need not be started again";
  }
  EXPECT_TRUE(CheckNoneRefused(database()));
  EXPECT_EQ(Check()->unmended(), 0);
}

TEST_F(RefusedPagesTest, IsNotWrittenAnewWithTheNextRow) {
  FlipByte(database(), offset_);
  {
    Store store = Open();
    const Status done =
        AppendSession(store, SessionId(DigestOf("next").str()), "{}", MakeManifest(1, kOtherRobot), {20});
    ASSERT_FALSE(done);
    EXPECT_THAT(Sentence(done.error()), HasSubstr(Refusal()));
    ASSERT_TRUE(AppendRobot(store, RobotId("another"), {21}));
  }
  ExpectFoundOnlyIn("session");
  EXPECT_FALSE(Back());
}

TEST_F(RefusedPagesTest, IsNotWrittenAnewByARepair) {
  const std::int64_t page = [&] {
    Store store = Open();
    EXPECT_TRUE(AppendLost(store, DigestOf(ContentOf(3)), BlobState::kMissing, {}, {20}));
    return store.database().execAndGet("SELECT pageno FROM dbstat WHERE name = 'blob_lost'").getInt64();
  }();
  FlipByte(database(), page * 4096 - 1);
  fs::remove(BlobOf(ContentOf(4)));  // which would be noted on the same page
  ExpectFoundOnlyIn("blob_lost", true);
  ExpectFoundOnlyIn("blob_lost");
}

TEST_F(RefusedPagesTest, IsRefusedWhereNothingIsWritten) {
  FlipByte(database(), offset_);
  SQLite::Database reader(database().string(), SQLite::OPEN_READONLY, 0, SummingFiles());
  EXPECT_THROW(reader.execAndGet("SELECT sum(length(manifest)) FROM session"), SQLite::Exception);
  EXPECT_EQ(reader.execAndGet("SELECT count(*) FROM robot").getInt(), 1);
}

TEST_F(RefusedPagesTest, TheFirstCountsThoughItIsReadBeforeTheLogIsKnown) {
  FlipByte(database(), 40);  // the cookie of the schema
  const auto store = Store::Open(data());
  ASSERT_FALSE(store);
  EXPECT_THAT(WordsOf(store), HasSubstr("page 1 of " + database().string() + " is not as rigcald wrote it"));
}

TEST_F(RefusedPagesTest, APageSizeThatTheDiskChangedIsNotBelieved) {
  for (const char high_byte : {0x08, 0x20}) {
    std::fstream(database(), std::ios::in | std::ios::out | std::ios::binary).seekp(16).put(high_byte);
    const auto store = Store::Open(data());
    ASSERT_FALSE(store) << int{high_byte};
    EXPECT_THAT(WordsOf(store), HasSubstr("page 1 of " + database().string() + " is not as rigcald wrote it"));
  }
}

// One that has next to nothing in memory, and is opened again and again, beside two that write into the database.
TEST_F(RefusedPagesTest, IsNoGoodOneWhileOthersWrite) {
  const auto write_on = [&](const std::string& name) {
    for (int i = 0; i < 40; ++i) {
      Store store = Open();
      Push(store, 20, RobotId(name + std::to_string(i)));
      if (i % 2 == 0) sqlite3_wal_checkpoint_v2(store.database().getHandle(), nullptr, i % 4, nullptr, nullptr);
    }
    _exit(HasFailure() ? 1 : 0);
  };
  std::vector<pid_t> writers;
  for (const char* name : {"a", "b"}) {
    writers.push_back(fork());
    if (writers.back() == 0) write_on(name);
  }
  int looks = 0;
  for (const pid_t writer : writers) {
    int status = 0;
    for (; waitpid(writer, &status, WNOHANG) == 0; ++looks) {
      Store store = Open();
      store.database().exec("PRAGMA cache_size = 4");
      EXPECT_EQ(QuickCheck(store), "ok");
    }
    EXPECT_EQ(status, 0);
  }
  EXPECT_GT(looks, 3);
  EXPECT_TRUE(CheckNoneRefused(database()));
}

}  // namespace
}  // namespace rigcal::storage
