// A log (WAL) that is not what was written to it is told before SQLite takes what it reads of it; what power loss
// tears, and what an earlier lap has left, is no damage.
#include "storage/database/log_damage.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include <random>

#include "storage/database/write_ahead_log.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;
using Kind = LogDamage::Kind;

constexpr std::int64_t kHeaderBytes = 32, kFrameBytes = 24 + 4096;

std::string BytesOf(const fs::path& file) { return ReadFile(file, 1 << 30).value(); }

LogLook LookAtBytes(const std::string& bytes) {
  const LogReader read = [&](std::int64_t offset, std::span<unsigned char> into) {
    const auto at = static_cast<std::size_t>(offset);
    if (at + into.size() > bytes.size()) return false;
    std::copy_n(bytes.begin() + offset, into.size(), into.begin());
    return true;
  };
  return LookAtLog(read, static_cast<std::int64_t>(bytes.size()));
}

void LeaveLastCommit(std::vector<LogFrame>& frames) {
  frames.pop_back();
  while (!frames.back().ends_commit) frames.pop_back();
}

std::int64_t BeginOfLast(std::vector<LogFrame> frames) {
  LeaveLastCommit(frames);
  return frames.back().offset + kFrameBytes;
}

class LogDamageTest : public UpkeepTest {
 protected:
  [[nodiscard]] fs::path database() const { return data() / "rigcal.db"; }
  [[nodiscard]] fs::path log() const { return LogFile(data()); }
  [[nodiscard]] std::int64_t Sessions() {
    Store store = Open();
    return store.database().execAndGet("SELECT count(*) FROM session").getInt64();
  }
  // A process that ends without closing the store leaves its log: of 8 sessions in 24 commits, after what is in the
  // database. `then` before it ends.
  void PushAndDie(const std::function<void(Store&)>& then = [](Store&) {}) {
    { Store made = Open(); }
    const pid_t child = fork();
    if (child == 0) {
      Store store = Open();
      for (int i = 0; i < 8; ++i) Push(store, 5, RobotId("robot-" + std::to_string(i)));
      then(store);
      _exit(0);
    }
    waitpid(child, nullptr, 0);
    ASSERT_TRUE(fs::exists(log()));
  }
  void Write(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  }
  // In the page of a frame in the middle.
  void FlipInTheMiddle() {
    const auto frames = static_cast<std::int64_t>(LookAtBytes(BytesOf(log())).read.size());
    FlipByte(log(), kHeaderBytes + frames / 2 * kFrameBytes + 500);
  }
};

TEST_F(LogDamageTest, AWholeLogHasNone) {
  PushAndDie();
  const LogLook look = LookAtBytes(BytesOf(log()));
  EXPECT_GE(look.read.size(), 24U);
  EXPECT_EQ(look.stops_at, static_cast<std::int64_t>(fs::file_size(log())));
  EXPECT_EQ(look.read_bytes, look.stops_at);
  EXPECT_TRUE(look.unread.empty());
  EXPECT_FALSE(FindLogDamage(data()));
  EXPECT_EQ(Sessions(), 8);
}

TEST_F(LogDamageTest, AnyByteOfAnyFrameBeforeTheLastTwoCommitsCounts) {
  PushAndDie();
  std::vector<LogFrame> frames = LookAtBytes(BytesOf(log())).read;
  LeaveLastCommit(frames);
  LeaveLastCommit(frames);
  for (std::size_t i = 0; i < frames.size(); i += 7)
    for (const std::int64_t within : {0, 5, 9, 21, 24 + 4095}) {  // page, size, salt, checksum, the page
      FlipByte(log(), frames[i].offset + within);
      const auto damage = FindLogDamage(data());
      ASSERT_TRUE(damage) << "frame " << i << " at " << within;
      EXPECT_EQ(damage->at_byte, frames[i].offset);
      EXPECT_EQ(damage->kind, Kind::kNotRead);
      EXPECT_GE(damage->commits, 1);
      FlipByte(log(), frames[i].offset + within);
    }
  EXPECT_FALSE(FindLogDamage(data()));
}

TEST_F(LogDamageTest, WithoutAHeaderNothingIsRead) {
  PushAndDie();
  for (const std::int64_t at : {1, 9, 13, 17, 25}) {
    FlipByte(log(), at);
    const auto damage = FindLogDamage(data());
    ASSERT_TRUE(damage) << at;
    EXPECT_EQ(damage->at_byte, 0);
    EXPECT_EQ(damage->read_bytes, 0);
    FlipByte(log(), at);
  }
}

TEST_F(LogDamageTest, NobodyOpensTheStoreUntilItIsRepaired) {
  PushAndDie();
  FlipInTheMiddle();
  const std::string damaged = BytesOf(log());
  const auto store = Store::Open(data());
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().what, HasSubstr("rigcal.db-wal is damaged at byte "));
  EXPECT_THAT(store.error().cure, HasSubstr("`rigcal fsck --repair " + data().string() + "`"));
  EXPECT_FALSE(Back());
  for (int i = 0; i < 2; ++i) {
    const auto found = FoundOf(*Check(), Finding::Kind::kLog);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_TRUE(found[0].is_damage && !found[0].is_mended);
    EXPECT_THAT(found[0].what, HasSubstr("commits behind it, which were acknowledged, would not be read"));
  }
  EXPECT_EQ(BytesOf(log()), damaged) << "it only looked";
}

TEST_F(LogDamageTest, ARepairKeepsTheLogAndTakesWhatLiesBefore) {
  PushAndDie();
  FlipInTheMiddle();
  const std::string damaged = BytesOf(log());
  const auto done = Check(true);
  ASSERT_TRUE(done) << WordsOf(done);
  EXPECT_EQ(done->unmended(), 1) << "what was lost is told";
  const fs::path kept = data() / ("rigcal.db-wal.damaged-" + Sha256Of(damaged).str().substr(0, 16));
  ASSERT_TRUE(fs::exists(kept));
  EXPECT_EQ(BytesOf(kept), damaged);
  const std::int64_t sessions = Sessions();
  EXPECT_GT(sessions, 0);
  EXPECT_LT(sessions, 8);
  const auto after = Check();
  EXPECT_EQ(after->unmended(), 0);
  EXPECT_THAT(FoundOf(*after, Finding::Kind::kAside).at(0).what, HasSubstr(kept.filename().string()));
  EXPECT_TRUE(Back());
}

TEST_F(LogDamageTest, FilesThatLostCommitsNamedAreLeft) {
  PushAndDie();
  FlipInTheMiddle();
  const pid_t other = fork();  // who repairs has the folder until it ends
  if (other == 0) _exit(Check(true) ? 0 : 1);
  waitpid(other, nullptr, 0);
  ASSERT_FALSE(FindLogDamage(data()));
  const ClockAt later({SystemClock().Now().ns + 2 * 86'400'000'000'000});
  ASSERT_TRUE(Fsck({data(), true}, later));
  EXPECT_TRUE(fs::exists(BlobOf(ContentOf(0, RobotId("robot-7")))));
}

TEST_F(LogDamageTest, NothingIsLostWhereTheDatabaseHasAllOfIt) {
  PushAndDie([](Store& store) { store.database().tryExec("PRAGMA wal_checkpoint(PASSIVE)"); });
  FlipInTheMiddle();
  ASSERT_TRUE(FindLogDamage(data()));
  EXPECT_EQ(FindLogDamage(data())->kind, Kind::kStored);
  EXPECT_FALSE(Store::Open(data())) << "it would read older pages over newer ones";
  EXPECT_EQ(Check(true)->unmended(), 0);
  EXPECT_EQ(Sessions(), 8);
}

TEST_F(LogDamageTest, WithoutAHeaderADatabaseThatHasAllOfItIsWhole) {
  PushAndDie([](Store& store) { store.database().tryExec("PRAGMA wal_checkpoint(PASSIVE)"); });
  FlipByte(log(), 17);
  EXPECT_FALSE(FindLogDamage(data()));
  EXPECT_EQ(Sessions(), 8);
}

TEST_F(LogDamageTest, WhereTheDatabaseHasAPartOfItNothingIsChanged) {
  PushAndDie();
  FlipInTheMiddle();
  const std::string damaged = BytesOf(log());
  const LogFrame newest = LookAtBytes(damaged).unread.back();
  std::string stored = BytesOf(database());
  const std::size_t at = (newest.page - std::size_t{1}) * 4096;
  stored.resize(std::max(stored.size(), at + 4096));
  stored.replace(at, 4096, damaged, static_cast<std::size_t>(newest.offset) + 24, 4096);
  Write(database(), stored);
  ASSERT_TRUE(FindLogDamage(data()));
  EXPECT_EQ(FindLogDamage(data())->kind, Kind::kHalfStored);
  EXPECT_EQ(Check(true)->unmended(), 1);
  EXPECT_EQ(BytesOf(log()), damaged);
  EXPECT_FALSE(Store::Open(data()));
}

TEST_F(LogDamageTest, DamageToTheLastCommitIsInDoubtUnlessPowerWasLost) {
  PushAndDie();
  EXPECT_FALSE(LogInDoubt(data()));
  const std::int64_t begin = BeginOfLast(LookAtBytes(BytesOf(log())).read);
  const auto end = static_cast<std::int64_t>(fs::file_size(log()));
  for (std::int64_t frame = begin; frame < end; frame += kFrameBytes) {
    FlipByte(log(), frame + 500);
    ASSERT_TRUE(LogInDoubt(data())) << frame;
    EXPECT_THAT(LogInDoubt(data())->what, HasSubstr("at byte " + std::to_string(frame) + ", cannot be read"));
    EXPECT_FALSE(FindLogDamage(data()));
    FlipByte(log(), frame + 500);
  }
  FlipByte(log(), begin + 500);
  const auto written = fs::last_write_time(log());
  fs::last_write_time(log(), written - std::chrono::hours(24 * 3650));
  EXPECT_FALSE(LogInDoubt(data()));
  fs::last_write_time(log(), written);
  const auto done = Check();
  EXPECT_EQ(done->unmended(), 0);
  EXPECT_THAT(FoundOf(*done, Finding::Kind::kLog).at(0).cure, HasSubstr("Push again what was pushed last"));
}

// Sectors of the last transaction, each there or what an earlier lap had there.
TEST_F(LogDamageTest, WhatPowerLossTearsIsNone) {
  PushAndDie();
  const std::string whole = BytesOf(log());
  const auto begin = static_cast<std::size_t>(BeginOfLast(LookAtBytes(whole).read));
  std::string earlier = whole;
  for (std::size_t at = kHeaderBytes; at < earlier.size(); at += kFrameBytes) earlier[at + 8] ^= 1;  // its salt
  std::mt19937 random(11);
  for (int i = 0; i < 300; ++i) {
    std::string torn = whole;
    for (std::size_t at = begin, next = 0; at < torn.size(); at = next) {
      next = std::min((at / 512 + 1) * 512, torn.size());
      if (random() % 3 == 0) std::copy(earlier.begin() + at, earlier.begin() + next, torn.begin() + at);
      if (random() % 9 == 0) std::fill(torn.begin() + at, torn.begin() + next, '\0');
    }
    if (random() % 4 == 0) torn.resize(begin + random() % (torn.size() - begin));
    const LogLook look = LookAtBytes(torn);
    EXPECT_FALSE(look.is_damaged) << i;
    EXPECT_GE(look.read_bytes, static_cast<std::int64_t>(begin));
  }
}

TEST_F(LogDamageTest, WhatAnEarlierLapHasLeftIsNone) {
  PushAndDie([](Store& store) {
    store.database().tryExec("PRAGMA wal_checkpoint(RESTART)");
    for (int i = 0; i < 3; ++i) Push(store, 1, RobotId("after-" + std::to_string(i)));
  });
  const LogLook look = LookAtBytes(BytesOf(log()));
  ASSERT_GT(static_cast<std::int64_t>(fs::file_size(log())), look.read_bytes + 10 * kFrameBytes);
  EXPECT_FALSE(look.is_damaged);
  EXPECT_TRUE(look.unread.empty());
  FlipByte(log(), look.read_bytes + 3 * kFrameBytes + 100);
  EXPECT_FALSE(FindLogDamage(data())) << "nobody reads that";
  FlipByte(log(), look.read[1].offset + 100);
  ASSERT_TRUE(FindLogDamage(data()));
  EXPECT_EQ(FindLogDamage(data())->at_byte, look.read[1].offset);
  FlipByte(log(), look.read[1].offset + 100);
  EXPECT_EQ(Check()->unmended(), 0);
  EXPECT_EQ(Sessions(), 11);
}

// Transactions that failed were written over by shorter ones: their commits are there, and were never acknowledged.
TEST_F(LogDamageTest, WhatWasWrittenOverIsNone) {
  PushAndDie();
  const std::string whole = BytesOf(log());
  const std::string last = whole.substr(static_cast<std::size_t>(BeginOfLast(LookAtBytes(whole).read)));
  ASSERT_GT(last.size(), kFrameBytes);
  const LogLook look = LookAtBytes(whole + last + last);
  EXPECT_GE(look.unread_commits, 2);
  EXPECT_FALSE(look.is_damaged);
}

TEST_F(LogDamageTest, WhoWritesMeanwhileMakesNone) {
  { Store made = Open(); }
  const pid_t child = fork();
  if (child == 0) {
    Store store = Open();
    store.database().exec("PRAGMA wal_autocheckpoint = 40");
    for (int i = 0;; ++i) Push(store, 3, RobotId("r" + std::to_string(i)));
  }
  for (int i = 0; i < 200; ++i) {
    EXPECT_FALSE(FindLogDamage(data())) << i;
    poll(nullptr, 0, 1);
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_FALSE(FindLogDamage(data()));
}

TEST_F(LogDamageTest, ALogThatIsGoneIsToldByItsIndex) {
  PushAndDie();
  fs::remove(log());
  EXPECT_FALSE(Store::Open(data()));
  EXPECT_FALSE(Back());
  EXPECT_THAT(FoundOf(*Check(), Finding::Kind::kLog).at(0).what, HasSubstr("rigcal.db-wal is not there, and the"));
  EXPECT_EQ(Check()->unmended(), 1);
  EXPECT_EQ(Check(true)->unmended(), 1) << "what was lost is told";
  EXPECT_EQ(Sessions(), 0);
  const auto after = Check();
  EXPECT_EQ(after->unmended(), 0);
  EXPECT_THAT(FoundOf(*after, Finding::Kind::kLog).at(0).what, HasSubstr("may be lost"));
}

TEST_F(LogDamageTest, WhereItsIndexIsGoneTooItIsInDoubtUntilARepair) {
  PushAndDie();
  fs::remove(log());
  fs::remove(LogIndexFile(data()));
  for (int i = 0; i < 2; ++i) {
    const auto done = Check();
    EXPECT_EQ(done->unmended(), 0);
    const auto found = FoundOf(*done, Finding::Kind::kLog);
    ASSERT_EQ(found.size(), 1U) << i;
    EXPECT_THAT(found[0].what, HasSubstr("went while no rigcald had closed it"));
    EXPECT_FALSE(found[0].is_damage);
  }
  EXPECT_EQ(FoundOf(*Check(true), Finding::Kind::kLog).size(), 1U);
  EXPECT_TRUE(FoundOf(*Check(), Finding::Kind::kLog).empty());
}

}  // namespace
}  // namespace rigcal::storage
