// A log that the disk changes under an open store: nothing of it is stored, served or gone on from.
#include "storage/database/log_guard.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <sqlite3.h>

#include "storage/database/log_damage.h"
#include "storage/database/refused_pages.h"
#include "tests/unit/upkeep/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;

class LogGuardTest : public UpkeepTest {
 protected:
  [[nodiscard]] fs::path database() const { return data() / "rigcal.db"; }
  [[nodiscard]] fs::path log() const { return LogFile(data()); }
  [[nodiscard]] std::vector<LogFrame> Frames() const {
    const std::string bytes = ReadFile(log(), 1 << 30).value();
    const LogReader read = [&](std::int64_t offset, std::span<unsigned char> into) {
      if (static_cast<std::size_t>(offset) + into.size() > bytes.size()) return false;
      std::copy_n(bytes.begin() + offset, into.size(), into.begin());
      return true;
    };
    return LookAtLog(read, static_cast<std::int64_t>(bytes.size())).read;
  }
  void Damage(const LogFrame& frame) const { FlipByte(log(), frame.offset + kLogFrameHeaderBytes + 100); }
  static int Checkpoint(Store& store, int mode = SQLITE_CHECKPOINT_PASSIVE) {
    return sqlite3_wal_checkpoint_v2(store.database().getHandle(), nullptr, mode, nullptr, nullptr);
  }
  [[nodiscard]] static std::string WordsAt(const LogFrame& frame) {
    return "rigcal.db-wal is damaged at byte " + std::to_string(frame.offset);
  }
};

TEST_F(LogGuardTest, NothingOfADamagedLogIsStoredAndNothingComesToIt) {
  LogFrame damaged;
  {
    Store store = Open();
    for (int i = 0; i < 4; ++i) Push(store, 5, RobotId("robot-" + std::to_string(i)));
    const auto frames = Frames();
    damaged = frames.at(frames.size() / 2);
    Damage(damaged);
    const std::string before = ReadFile(database(), 1 << 30).value();
    EXPECT_EQ(Checkpoint(store), SQLITE_CORRUPT);
    EXPECT_EQ(ReadFile(database(), 1 << 30).value(), before) << "not even what lies before the damage";
    EXPECT_THAT(WordsOf(CheckNoneRefused(database())), HasSubstr(WordsAt(damaged)));
    const auto appended = AppendSession(store, SessionId(DigestOf("another").str()), "{}", MakeManifest(1), {10});
    ASSERT_FALSE(appended) << "it would be lost at the next start";
    EXPECT_THAT(Sentence(appended.error()), HasSubstr(WordsAt(damaged)));
  }
  const auto found = FindLogDamage(data());
  ASSERT_TRUE(found) << "who closes it leaves it as it is";
  EXPECT_EQ(found->kind, LogDamage::Kind::kNotRead);
  EXPECT_EQ(found->at_byte, damaged.offset);
}

TEST_F(LogGuardTest, ADamagedPageOfItIsNotServed) {
  Store store = Open();
  Push(store, 5);
  const LogFrame newest = Frames().back();
  Damage(newest);
  sqlite3_db_release_memory(store.database().getHandle());
  const auto look = [&] { return store.database().execAndGet("PRAGMA integrity_check").getString(); };
  try {
    EXPECT_NE(look(), "ok");
  } catch (const SQLite::Exception& refused) {
    EXPECT_EQ(refused.getErrorCode(), SQLITE_CORRUPT);
  }
  EXPECT_THAT(WordsOf(CheckNoneRefused(database())), HasSubstr(WordsAt(newest)));
}

// Of those frames SQLite mends the sums only when it commits.
TEST_F(LogGuardTest, WhatATransactionWritesOverIsNoDamage) {
  Store store = Open();
  SQLite::Database& rows = store.database();
  rows.exec("PRAGMA cache_size = 5");
  rows.exec("BEGIN IMMEDIATE; CREATE TABLE large (number INTEGER PRIMARY KEY, bytes BLOB)");
  for (int i = 0; i < 100; ++i) rows.exec("INSERT INTO large (bytes) VALUES (zeroblob(3000))");
  for (int i = 0; i < 3; ++i) rows.exec("UPDATE large SET bytes = randomblob(3000)");
  EXPECT_EQ(rows.execAndGet("SELECT sum(length(bytes)) FROM large").getInt64(), 300'000);
  rows.exec("COMMIT");
  EXPECT_EQ(rows.execAndGet("PRAGMA integrity_check").getString(), "ok");
  EXPECT_EQ(Checkpoint(store, SQLITE_CHECKPOINT_TRUNCATE), SQLITE_OK);
  EXPECT_TRUE(CheckNoneRefused(database()));
}

}  // namespace
}  // namespace rigcal::storage
