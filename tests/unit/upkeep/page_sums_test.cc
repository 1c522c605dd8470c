// The sums of pages are those of what was written, whoever died meanwhile.
#include "storage/database/page_sums.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <random>

#include "storage/upkeep/page_check.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

// While it lives no file can be opened: the process has as many open as it may.
class NoHandles {
 public:
  NoHandles() {
    getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{0, before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoHandles() { setrlimit(RLIMIT_NOFILE, &before_); }
  NoHandles(const NoHandles&) = delete;
  NoHandles& operator=(const NoHandles&) = delete;

 private:
  rlimit before_{};
};

class PageSumsTest : public UpkeepTest {
 protected:
  [[nodiscard]] fs::path database() const { return data() / "rigcal.db"; }
  [[nodiscard]] fs::path log() const { return data() / "rigcal.db-wal"; }
  // A process that ends without closing the store leaves its log.
  void PushAndDie() {
    const pid_t child = fork();
    if (child == 0) {
      Store store = Open();
      Push(store, 30);
      _exit(0);
    }
    waitpid(child, nullptr, 0);
    ASSERT_TRUE(fs::exists(log()));
  }
};

TEST_F(PageSumsTest, EveryPageOfANewStoreHasOne) {
  {
    Store store = Open();
    Push(store, 100);
  }
  const PageLook look = LookAtPages(database()).value();
  EXPECT_EQ(look.pages * 4096, static_cast<std::int64_t>(fs::file_size(database())));
  EXPECT_EQ(look.unknown, 0);
  EXPECT_TRUE(look.damaged.empty());
}

TEST_F(PageSumsTest, AnyByteOfAnyPageCounts) {
  {
    Store store = Open();
    Push(store, 100);
  }
  std::mt19937 random(7);
  std::uniform_int_distribution<std::int64_t> offsets(0, static_cast<std::int64_t>(fs::file_size(database())) - 1);
  for (int i = 0; i < 200; ++i) {
    const std::int64_t offset = offsets(random);
    FlipByte(database(), offset);
    EXPECT_THAT(LookAtPages(database())->damaged, testing::ElementsAre(offset / 4096 + 1));
    FlipByte(database(), offset);
  }
}

TEST_F(PageSumsTest, AreGoodAfterEveryKill) {
  constexpr int kRounds = 15;
  std::mt19937 random(20261126);
  for (int round = 0; round < kRounds; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      Store store = Open();
      for (std::size_t i = 0;; ++i) Push(store, 30, RobotId("r" + std::to_string(round) + "-" + std::to_string(i)));
    }
    poll(nullptr, 0, std::uniform_int_distribution<int>(20, 200)(random));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    Store store = Open();
    const auto look = LookAtPages(store.connection(), database());
    ASSERT_TRUE(look) << WordsOf(look);
    EXPECT_TRUE(look->damaged.empty()) << "round " << round;
    EXPECT_EQ(look->unknown, 0);
    EXPECT_EQ(store.database().execAndGet("PRAGMA quick_check").getString(), "ok") << "no good page is refused";
  }
}

TEST_F(PageSumsTest, AreForgottenWhereAnotherProgramWroteTheLogIntoTheDatabase) {
  PushAndDie();
  {
    SQLite::Database other(database().string(), SQLite::OPEN_READWRITE);  // an older rigcald, `sqlite3`: it only looks
    EXPECT_GT(other.execAndGet("SELECT count(*) FROM session").getInt(), 0);
  }
  ASSERT_FALSE(fs::exists(log()));
  EXPECT_TRUE(Store::Open(data())) << "its first page is read before the log is there";
  const auto done = Check();
  ASSERT_TRUE(done) << WordsOf(done);
  EXPECT_EQ(done->unmended(), 0);
  EXPECT_EQ(done->pages_unknown, done->pages);
  EXPECT_TRUE(Back());
  EXPECT_EQ(Check(true)->unmended(), 0);
  EXPECT_EQ(Check()->pages_unknown, 0);
}

// The second leaves a log of its own, empty, as it cannot remove it.
TEST_F(PageSumsTest, AreForgottenWhereAnotherLogTookThePlaceOfTheirs) {
  PushAndDie();
  for (const int how : {SQLite::OPEN_READWRITE, SQLite::OPEN_READONLY}) {
    SQLite::Database other(database().string(), how);
    EXPECT_GT(other.execAndGet("SELECT count(*) FROM session").getInt(), 0);
  }
  ASSERT_TRUE(fs::exists(log()));
  const auto opened = Store::Open(data());
  EXPECT_TRUE(opened) << WordsOf(opened);
  EXPECT_EQ(Check()->unmended(), 0);
}

// Links to one file are two files there.
TEST_F(PageSumsTest, StayInACopyOfTheFolderOfAKilledProcess) {
  PushAndDie();
  const fs::path copy = data().string() + "-copy";
  fs::copy(data(), copy, fs::copy_options::recursive);
  {
    auto first = Store::Open(copy);
    ASSERT_TRUE(first) << WordsOf(first);
    Push(*first, 100, RobotId("later"));
    const auto second = Store::Open(copy);
    EXPECT_TRUE(second) << WordsOf(second);
    EXPECT_FALSE(fs::exists(copy / "rigcal.db-log-went"));
    EXPECT_EQ(LookAtPages(first->connection(), copy / "rigcal.db")->unknown, 0);
  }
  EXPECT_FALSE(fs::exists(copy / "rigcal.db-sums-log"));
}

TEST_F(PageSumsTest, StayWhereTheNextProcessWritesTheLogIntoTheDatabase) {
  PushAndDie();
  EXPECT_EQ(Check()->pages_unknown, 0);
  ASSERT_FALSE(fs::exists(log()));
  EXPECT_FALSE(fs::exists(data() / "rigcal.db-sums-log"));
  FlipByte(database(), 9000);
  EXPECT_EQ(Check()->unmended(), 1);
}

TEST_F(PageSumsTest, AreNotThoseOfBeforeWhereNoHandleWasLeft) {
  fs::create_directories(data());
  const std::string before(kPageBytes, 'a'), now(kPageBytes, 'b');
  PageSums first(database(), PageSums::Access::kNote);
  first.Note(before.data(), kPageBytes, 0);
  const auto second = [&] {
    const NoHandles none;
    auto late = std::make_unique<PageSums>(database(), PageSums::Access::kNote);
    late->Note(now.data(), kPageBytes, 0);
    return late;
  }();
  EXPECT_EQ(first.Of(0), 0U);
  second->Note(now.data(), kPageBytes, 0);
  EXPECT_EQ(first.Of(0), SumOfPage(0, now.data()));
}

TEST_F(PageSumsTest, ThoseOfAnOlderStoreAreNotedWhenAskedFor) {
  {
    Store store = Open();
    Push(store, 100);
  }
  fs::resize_file(PageSumsFile(database()), 0);
  const std::int64_t pages = LookAtPages(database())->pages;
  EXPECT_EQ(LookAtPages(database())->unknown, pages);
  EXPECT_EQ(Check()->unmended(), 0);
  const auto mended = Check(true);
  EXPECT_EQ(mended->unmended(), 0);
  ASSERT_EQ(FoundOf(*mended, Finding::Kind::kPage).size(), 1U) << "who notes what nobody vouches for says so";
  EXPECT_THAT(FoundOf(*mended, Finding::Kind::kPage).front().what,
              testing::StartsWith(std::to_string(pages) + " pages of rigcal.db had no sum"));
  EXPECT_EQ(LookAtPages(database())->unknown, 0);
  FlipByte(database(), 9000);
  EXPECT_EQ(LookAtPages(database())->damaged.size(), 1U);
}

TEST_F(PageSumsTest, AFileThatIsGoneIsDamage) {
  {
    Store store = Open();
    Push(store, 100);
  }
  fs::remove(PageSumsFile(database()));
  const auto done = Check();
  EXPECT_EQ(done->unmended(), 1);
  EXPECT_THAT(FoundOf(*done, Finding::Kind::kPage).front().what, testing::StartsWith("rigcal.db-sums is gone"));
  fs::remove(PageSumsFile(database()));
  const auto mended = Check(true);
  EXPECT_EQ(mended->unmended(), 0);
  EXPECT_EQ(FoundOf(*mended, Finding::Kind::kPage).size(), 2U);
  EXPECT_EQ(Check()->unmended(), 0);
}

}  // namespace
}  // namespace rigcal::storage
