// A copy that was broken off goes on, and until it is whole there is no store.
#include "storage/files/folder_lock.h"
#include "storage/upkeep/open_unchanged.h"
#include "tests/unit/move/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;

void PushTwice(Store store) {
  Push(store, 3, RobotId("mapper-05"));
  Push(store, 4, RobotId("mapper-06"));
}

void AuditOnce(Store store, const std::string& who) { ASSERT_TRUE(AppendAudit(store, {5}, who, "pushed")); }

TEST_F(MoveTest, GoesOnAfterAKillAtAnyStep) {
  FillStore();
  int steps = 0;
  MoveOptions counted = options();
  counted.progress = [&](MoveStage, std::int64_t, std::int64_t) { ++steps; };
  counted.to = folder_.path() / "counted";
  ASSERT_TRUE(MoveStore(counted));
  Store original = Open();
  const auto counts = CountsOf(original);
  for (int step = 1; step <= steps; step += 1 + steps / 9) {
    SCOPED_TRACE(step);
    const TempDatabase database;
    MoveOptions words = options();
    words.to = database.In(folder_.path() / ("copy-" + std::to_string(step)));
    KillAfter(step, words);
    EXPECT_THAT(WordsOf(Store::Open(words.to)), HasSubstr("is a copy of another that is not finished"));
    KillAfter(3, words);
    const auto moved = MoveStore(words);
    ASSERT_TRUE(moved) << WordsOf(moved);
    EXPECT_TRUE(moved->went_on);
    Store copy = Store::Open(words.to).value();
    EXPECT_EQ(CountsOf(copy), counts);
  }
}

TEST_F(MoveTest, BeginsAnewWhereTheStoreChangedMeanwhile) {
  FillStore();
  KillAfter(40, options());
  PushTwice(Open());
  const auto moved = Move();
  ASSERT_TRUE(moved) << WordsOf(moved);
  EXPECT_FALSE(moved->went_on);
  Store original = Open(), copy = Store::Open(to()).value();
  EXPECT_EQ(CountsOf(copy), CountsOf(original));
}

TEST_F(MoveTest, BeginsAnewWhereARowWasReplacedMeanwhile) {
  FillStore();
  KillAfter(100, options());  // all rows are copied
  TamperWith(from(), "UPDATE summary_robot SET site = 'Shanghai'");
  const auto moved = Move();
  ASSERT_TRUE(moved) << WordsOf(moved);
  EXPECT_FALSE(moved->went_on);
  Store copy = Store::Open(to()).value();
  EXPECT_EQ(TextIn(copy, "SELECT site FROM summary_robot"), "Shanghai");
}

TEST_F(MoveTest, NobodyOpensAnUnfinishedCopy) {
  FillStore();
  KillAfter(30, options());
  EXPECT_THAT(WordsOf(Store::Open(to())), HasSubstr("is a copy of another that is not finished"));
  if (IsOnSqlite()) {
    EXPECT_THAT(WordsOf(OpenUnchanged(to().folder)), HasSubstr("Run the same `rigcal migrate-store` again"));
  }
}

TEST_F(MoveTest, ACopyThatWasFinishedIsLeftAsItIs) {
  FillStore();
  ASSERT_TRUE(Move());
  std::ofstream(to().folder / "unfinished-copy") << fs::canonical(data()).string() + "\n" + NameOf(to()) + "\n";
  const auto again = Move();
  ASSERT_TRUE(again) << WordsOf(again);
  EXPECT_TRUE(again->was_there);
  EXPECT_FALSE(fs::exists(to().folder / "unfinished-copy"));
  EXPECT_THAT(Refusal(), HasSubstr("is not empty"));
}

TEST_F(MoveTest, AnotherStoreInTheFolderIsNotTheCopy) {
  FillStore();
  ASSERT_TRUE(Store::Open(to()));
  std::ofstream(to().folder / "unfinished-copy") << fs::canonical(data()).string() + "\n" + NameOf(to()) + "\n";
  EXPECT_THAT(Refusal(), HasSubstr("there is a store at"));
}

TEST_F(MoveTest, NobodyMakesAStoreWhereACopyIsBegun) {
  fs::create_directories(to().folder);
  std::ofstream(to().folder / "unfinished-copy") << fs::canonical(data().parent_path()).string() << "\n";
  EXPECT_THAT(WordsOf(Store::Open(to())), HasSubstr("is a copy of another that is not finished"));
}

TEST_F(MoveTest, RefusesWhatIsInUse) {
  FillStore();
  auto held = HoldFolder(data());
  ASSERT_TRUE(held);
  EXPECT_THAT(Refusal(), HasSubstr("conflict: a rigcald uses the store at"));
  held = HoldFolder(to().folder);  // lets go of the other
  ASSERT_TRUE(held);
  EXPECT_THAT(Refusal(), HasSubstr("another process uses the folder"));
}

TEST_F(MoveTest, NobodyWritesToTheStoreMeanwhile) {
  FillStore();
  std::string said;
  MoveOptions words = options();
  Store other = Open();
  words.progress = [&](MoveStage stage, std::int64_t, std::int64_t) {
    if (stage != MoveStage::kCopyingFiles || !said.empty()) return;
    const Status written = other.WriteSoon([]() -> Status { return {}; });
    said = written ? "written" : NameOf(written.error().code);
  };
  ASSERT_TRUE(MoveStore(words));
  EXPECT_EQ(said, "busy");
}

TEST_F(MoveTest, RefusesWhatIsSomethingElse) {
  EXPECT_THAT(Refusal(), HasSubstr("holds no store"));
  EXPECT_FALSE(fs::exists(data()));
  FillStore();
  fs::create_directories(to().folder);
  std::ofstream(to().folder / "notes.txt") << "mine";
  EXPECT_THAT(Refusal(), HasSubstr("is not empty"));
  fs::remove(to().folder / "notes.txt");
  ASSERT_TRUE(Move());
  EXPECT_THAT(Refusal(), HasSubstr("is not empty"));
  MoveOptions words = options();
  words.to.folder = folder_.path() / "new";
  if (!IsOnSqlite()) {
    EXPECT_THAT(WordsOf(MoveStore(words)), HasSubstr("there is a store at postgresql://"));
  }
  EXPECT_EQ(fs::exists(words.to.folder), false);
  words.to = data() / "within";
  EXPECT_THAT(WordsOf(MoveStore(words)), HasSubstr("one lies in the other"));
}

TEST_F(MoveTest, RefusesTheUnfinishedCopyOfAnotherStore) {
  FillStore();
  KillAfter(30, options());
  fs::create_directory(folder_.path() / "other");
  ASSERT_TRUE(Store::Open(folder_.path() / "other"));
  MoveOptions words = options();
  words.from = folder_.path() / "other";
  EXPECT_THAT(WordsOf(MoveStore(words)),
              HasSubstr("is that of the unfinished copy of " + fs::canonical(data()).string()));
  words = options();
  words.to.folder = folder_.path() / "new";
  if (!IsOnSqlite()) {
    EXPECT_THAT(WordsOf(MoveStore(words)), HasSubstr("or of this one with another folder"));
  }
}

TEST_F(MoveTest, RefusesADamagedStore) {
  FillStore();
  FlipByte(data() / "rigcal.db", 9 * 4096 + 100);
  EXPECT_THAT(Refusal(), HasSubstr("is damaged at page 10"));
}

TEST_F(MoveTest, RefusesAStoreOfAnotherVersion) {
  FillStore();
  TamperWith(from(), "PRAGMA user_version = 9999");
  EXPECT_THAT(Refusal(), HasSubstr("has schema version 9999"));
}

TEST_F(MoveTest, NamesATextThatPostgresDoesNotTake) {
  if (IsOnSqlite()) GTEST_SKIP() << "of PostgreSQL";
  AuditOnce(Open(), std::string("A\0a", 3));
  EXPECT_THAT(Refusal(), testing::AllOf(HasSubstr("the copy of the table audit"), HasSubstr("without zero bytes")));
}

}  // namespace
}  // namespace rigcal::storage
