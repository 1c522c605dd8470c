#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "storage/database/query.h"
#include "storage/migrate.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/old_store.h"

namespace rigcal::storage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

std::string BytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::int64_t CountRobots(Store& store) { return IntIn(store, "SELECT count(*) FROM robot"); }

TEST(StoreOpen, MakesAnEmptyStoreThatOpensAgain) {
  const TempFolder folder;
  const fs::path deep = folder.path() / "new" / "deeper";
  for (int round = 0; round < 2; ++round) {
    Result<Store> store = Store::Open(deep);
    ASSERT_TRUE(store) << WordsOf(store);
    EXPECT_EQ(store->SchemaVersion(), NewestSchemaVersion());
    EXPECT_EQ(store->folder(), deep);
    EXPECT_TRUE(fs::is_directory(store->BlobFolder() / "a7"));
    EXPECT_TRUE(fs::is_directory(store->IntakeFolder()));
    EXPECT_TRUE(fs::is_directory(store->ReportFolder()));
  }
}

// Every table, index, view and trigger as it is written down, and every row.
std::vector<std::string> WhatIsIn(SQLite::Database& database) {
  std::vector<std::string> all, tables;
  SQLite::Statement made(database, "SELECT type, name, tbl_name, coalesce(sql, '') FROM sqlite_master");
  while (made.executeStep()) {
    if (made.getColumn(0).getString() == "table") tables.push_back(made.getColumn(1).getString());
    for (int column = 1; column < 4; ++column) all.push_back(made.getColumn(column).getString());
  }
  for (const std::string& table : tables) {
    SQLite::Statement rows(database, "SELECT * FROM \"" + table + "\"");
    while (rows.executeStep()) {
      std::string row = table;
      for (int column = 0; column < rows.getColumnCount(); ++column) row += "|" + rows.getColumn(column).getString();
      all.push_back(row);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

// A new store is made by one script; what became of an old one by the files that came since.
TEST(StoreOpen, ANewStoreIsWhatTheFilesOfItsSchemaMake) {
  const TempFolder made, grown;
  MakeDatabase(grown.path(), EmptyStoreOfVersion(NewestSchemaVersion()));
  ASSERT_TRUE(Store::Open(made.path()));
  SQLite::Database one((made.path() / "rigcal.db").string(), SQLite::OPEN_READONLY, 0, SummingFiles()),
      other((grown.path() / "rigcal.db").string(), SQLite::OPEN_READONLY, 0, SummingFiles());
  EXPECT_EQ(WhatIsIn(one), WhatIsIn(other));
  EXPECT_GT(WhatIsIn(one).size(), 300u);
}

TEST_F(StoreTest, IsSetForDurability) {
  if (!IsOnSqlite()) GTEST_SKIP() << "asks SQLite for its settings";
  const auto setting = [&](const char* name) { return TextIn(store_, std::string("PRAGMA ") + name); };
  EXPECT_EQ(setting("journal_mode"), "wal");
  EXPECT_EQ(setting("synchronous"), "2");
  EXPECT_EQ(setting("foreign_keys"), "1");
  EXPECT_EQ(setting("busy_timeout"), "10000");
}

TEST(StoreOpen, MigratesAnEmptyFile) {
  const TempFolder folder;
  std::ofstream(folder.path() / "rigcal.db").close();
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_EQ(store->SchemaVersion(), NewestSchemaVersion());
  EXPECT_EQ(CountRobots(*store), 0);
}

TEST(StoreOpen, MigratesTheFirstVersionWithWhatItHolds) {
  const TempFolder folder;
  MakeDatabase(
      folder.path(),
      EmptyStoreOfVersion(1) +
          "INSERT INTO robot VALUES ('mapper-01', 1);"
          "INSERT INTO detected_view VALUES (printf('%064d', 7), 'checkerboard', 1, '', 'board', "
          "640, 480, zeroblob(32), NULL);"
          "INSERT INTO edge VALUES (1, printf('%064d', 8), 'mapper-01', NULL, 1, 'left', 'right', 'stereo', 'good', 5, "
          "1, 0, 0, 0, 0, 0, 1, zeroblob(288), 0, 12, 'jackknife', zeroblob(288), zeroblob(288));"
          "INSERT INTO revision VALUES ('mapper-01', 1, 6, 1, 'pass', '', '', printf('%064d', 9), '{}')");
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  EXPECT_EQ(store->SchemaVersion(), NewestSchemaVersion());
  EXPECT_EQ(CountRobots(*store), 1);
  const auto view = LoadView(*store, Digest(std::string(63, '0') + "7"), "checkerboard");
  ASSERT_TRUE(view && *view);
  EXPECT_EQ((*view)->view.corner_idx, (std::vector<int>{0, 1}));
  const auto edges = LoadEdges(*store, RobotId("mapper-01"), true);
  ASSERT_TRUE(edges && edges->size() == 1);
  EXPECT_EQ(edges->front().uncertainty.dof, 12);
  EXPECT_EQ(edges->front().uncertainty.jackknife_ratio, 0.0);  // not told
  const auto revision = LoadRevision(*store, RobotId("mapper-01"), 1);
  ASSERT_TRUE(revision && *revision);
  EXPECT_EQ((*revision)->calibrated_at, Stamp{5});
}

std::string SqlOfEdge(int number, const std::string& robot) {
  const std::string digits = std::to_string(number);
  return "INSERT INTO edge (number, edge_id, robot_id, epoch, frame_a, frame_b, method, state, appended_ns) VALUES (" +
         digits + ", printf('%064d', " + digits + "), '" + robot + "', 1, 'left', 'right', 'stereo', 'failed', 5);";
}

// Three of four items of a batch came: 1 and 2 were published before that was known to be wrong, 4 was not. 3 is of no
// batch, 5 came in a complete batch as well.
TEST(StoreOpen, MigratesABatchThatIsNotWhole) {
  const TempFolder folder;
  std::string sql = EmptyStoreOfVersion(4);
  sql += "INSERT INTO robot VALUES ('a', 1), ('b', 1);";
  for (const int number : {1, 2, 3, 4, 5}) sql += SqlOfEdge(number, "a");
  sql += SqlOfEdge(6, "b") +
         "INSERT INTO batch VALUES (1, 'half', 'a', 5, 1), (2, 'whole', 'a', 1, 1), (3, 'lone', 'b', 2, 1);"
         "INSERT INTO waiting_batch VALUES (1, 'a', 1, 1), (3, 'b', 1, 1);"
         "INSERT INTO batch_item VALUES (1, 0, 1), (1, 1, 2), (1, 2, 4), (1, 3, 5), (2, 0, 5), (3, 0, 6);"
         "INSERT INTO revision VALUES ('a', 1, 1, 2, 'pass', '', '', '', '{}')";
  MakeDatabase(folder.path(), sql);
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store) << WordsOf(store);
  std::vector<std::string> counted;
  const auto edges = LoadEdges(*store, RobotId("a"), true);
  ASSERT_TRUE(edges) << WordsOf(edges);
  for (const Edge& edge : *edges) counted.push_back(edge.id.str().substr(63));
  EXPECT_THAT(counted, testing::ElementsAre("1", "2", "3", "5"));
  EXPECT_TRUE(LoadEdges(*store, RobotId("b"), true).value().empty());
  EXPECT_EQ(LoadUnsolvedRobots(*store).value(), std::vector<RobotId>{RobotId("a")});  // 3 and 5 are in no revision
}

TEST(StoreOpen, LeavesANewerStoreAsItIs) {
  const TempFolder folder;
  { ASSERT_TRUE(Store::Open(folder.path())); }
  MakeDatabase(folder.path(), "PRAGMA journal_mode = DELETE; PRAGMA user_version = 99; CREATE TABLE future (x)");
  const std::string before = BytesOf(folder.path() / "rigcal.db");
  const Result<Store> store = Store::Open(folder.path());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kUnsupported);
  EXPECT_EQ(Sentence(store.error()), "the store at " + folder.path().string() +
                                         " has schema version 99, this rigcald understands up to " +
                                         std::to_string(NewestSchemaVersion()) +
                                         ". "
                                         "Install the rigcald that wrote it, or a newer one.");
  EXPECT_EQ(BytesOf(folder.path() / "rigcal.db"), before);
}

TEST(StoreOpen, RefusesTheDatabaseOfAnotherProgram) {
  const TempFolder folder;
  MakeDatabase(folder.path(), "CREATE TABLE recipe (name TEXT)");
  const std::string before = BytesOf(folder.path() / "rigcal.db");
  const Result<Store> store = Store::Open(folder.path());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kConflict);
  EXPECT_THAT(store.error().what, HasSubstr("is a database, but not a store of rigcal"));
  EXPECT_EQ(BytesOf(folder.path() / "rigcal.db"), before);
}

TEST(StoreOpen, RefusesAFileThatIsNoDatabase) {
  const TempFolder folder;
  std::ofstream(folder.path() / "rigcal.db") << std::string(5000, 'x');
  const Result<Store> store = Store::Open(folder.path());
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kStorage);
  EXPECT_THAT(Sentence(store.error()), AllOf(HasSubstr(folder.path().string()), HasSubstr("file is not a database"),
                                             HasSubstr("restore it from a backup")));
}

TEST(StoreOpen, NamesADamagedDatabase) {
  const TempFolder folder;
  {
    Result<Store> store = Store::Open(folder.path());
    ASSERT_TRUE(store);
    ASSERT_TRUE(AppendRobot(*store, kRobot, {1}));
  }
  const std::uintmax_t size_bytes = fs::file_size(folder.path() / "rigcal.db");
  std::fstream file(folder.path() / "rigcal.db", std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(4096);
  file << std::string(size_bytes - 4096, '\x5a');
  file.close();
  const auto words = [&] {
    Result<Store> store = Store::Open(folder.path());
    return WordsOf(store ? LoadRobot(*store, kRobot).error() : store.error());
  };
  EXPECT_THAT(words(), AllOf(HasSubstr("storage: "),
                             HasSubstr(" of " + (folder.path() / "rigcal.db").string() + " is not as rigcald wrote it"),
                             HasSubstr("restore the newest backup")));
  fs::remove(folder.path() / "rigcal.db-sums");  // a store from before there were any
  EXPECT_THAT(words(), AllOf(HasSubstr("storage: "), HasSubstr("malformed"), HasSubstr("restore it from a backup")));
}

TEST(StoreOpen, RefusesAFolderThatIsAFile) {
  const TempFolder folder;
  std::ofstream(folder.path() / "data") << "x";
  const Result<Store> store = Store::Open(folder.path() / "data");
  ASSERT_FALSE(store);
  EXPECT_EQ(store.error().code, ErrorCode::kStorage);
  EXPECT_THAT(store.error().what, HasSubstr((folder.path() / "data").string()));
}

// Exit code 0 if a user without rights is refused with a sentence.
int OpenAsNobody(const fs::path& folder) {
  if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) return 3;
  const Result<Store> store = Store::Open(folder);
  if (store) return 1;
  const bool clear = Sentence(store.error()).find("this user may write") != std::string::npos;
  return clear && store.error().code == ErrorCode::kStorage ? 0 : 2;
}

int ExitCodeOf(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(StoreOpen, RefusesAFolderThatMayNotBeWritten) {
  const TempFolder folder;
  fs::permissions(folder.path(),
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  EXPECT_EQ(ExitCodeOf([&] { return OpenAsNobody(folder.path()); }), 0);
  EXPECT_EQ(ExitCodeOf([&] { return OpenAsNobody(folder.path() / "new"); }), 0);
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST(StoreOpen, RefusesAStoreThatMayNotBeWritten) {
  const TempFolder folder;
  { ASSERT_TRUE(Store::Open(folder.path())); }
  fs::permissions(folder.path(),
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  fs::permissions(folder.path() / "rigcal.db", fs::perms::owner_read | fs::perms::others_read);
  EXPECT_EQ(ExitCodeOf([&] { return OpenAsNobody(folder.path()); }), 0);
  fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST(StoreOpen, ManyAtOnceMakeOneStore) {
  const TempFolder folder;
  std::vector<std::string> words(8);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < words.size(); ++i)
    threads.emplace_back([&, i] {
      Result<Store> store = Store::Open(folder.path());
      words[i] = store ? WordsOf(AppendRobot(*store, RobotId("r" + std::to_string(i)), {1})) : WordsOf(store);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(words, testing::Each("good"));
  Result<Store> store = Store::Open(folder.path());
  ASSERT_TRUE(store);
  EXPECT_EQ(CountRobots(*store), 8);
}

// PostgreSQL's folder, or one whose database is gone.
TEST(StoreOpen, BeginsNoDatabaseBesideFilesOfAStore) {
  const TempFolder folder;
  ASSERT_TRUE(Store::Open(folder.path()));
  for (const char* file : {"rigcal.db", "rigcal.db-wal", "rigcal.db-shm"}) fs::remove(folder.path() / file);
  ASSERT_TRUE(Store::Open(folder.path())) << "nothing lies there yet";
  const fs::path blob = folder.path() / "blobs" / "a7" / ("a7" + std::string(62, '0'));
  std::ofstream(blob) << "picture";
  ASSERT_TRUE(Store::Open(folder.path())) << "it has its database";
  for (const char* file : {"rigcal.db", "rigcal.db-wal", "rigcal.db-shm"}) fs::remove(folder.path() / file);
  for (int round = 0; round < 2; ++round) {
    const auto refused = Store::Open(folder.path());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
    EXPECT_THAT(refused.error().what, HasSubstr("holds the files of a store"));
  }
  EXPECT_EQ(BytesOf(blob), "picture");
}

TEST_F(StoreTest, AnErrorInAWriteLeavesNothing) {
  const Status done = store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendRobot(store_, kRobot, {1}));
    return Fail(ErrorCode::kConflict, "no", "No.");
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().what, "no");
  EXPECT_EQ(CountRobots(store_), 0);
  EXPECT_TRUE(store_.Write([&] { return AppendRobot(store_, kRobot, {1}); }));
  EXPECT_EQ(CountRobots(store_), 1);
}

TEST_F(StoreTest, AnExceptionInAWriteIsAnErrorAndLeavesNothing) {
  const Status engine = store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendRobot(store_, kRobot, {1}));
    Query(store_, "SELECT * FROM nowhere").Run();
    return {};
  });
  ASSERT_FALSE(engine);
  EXPECT_EQ(engine.error().code, ErrorCode::kStorage);
  const Status other = store_.Write([&]() -> Status { throw std::runtime_error("boom"); });
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kInternal);
  EXPECT_EQ(CountRobots(store_), 0);
}

TEST_F(StoreTest, AFailureOfTheEngineDoomsTheWriteEvenIfItIsSwallowed) {
  Edge orphan = MakeEdge(1);
  orphan.session = SessionId(DigestOf("never stored").str());
  const Status done = store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendRobot(store_, kRobot, {1}));
    EXPECT_FALSE(AppendEdge(store_, orphan, {1}));
    EXPECT_FALSE(AppendRobot(store_, RobotId("other"), {1}));
    return {};
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kConflict);
  EXPECT_THAT(done.error().what,
              AllOf(HasSubstr(orphan.id.str()), HasSubstr(IsOnSqlite() ? "FOREIGN KEY" : "foreign key")));
  EXPECT_EQ(CountRobots(store_), 0);
}

TEST_F(StoreTest, RefusedInputDoesNotDoomTheWrite) {
  ASSERT_TRUE(store_.Write([&]() -> Status {
    Edge edge = MakeEdge(1);
    edge.T_a_b.p_m.z() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(AppendEdge(store_, edge, {1}));
    return AppendEdge(store_, MakeEdge(2), {1});
  }));
  EXPECT_EQ(LoadEdges(store_, kRobot, true)->size(), 1u);
}

TEST_F(StoreTest, AWriteDoesNotNestButAReadDoes) {
  const Status nested = store_.Write([&] { return store_.Write([]() -> Status { return {}; }); });
  ASSERT_FALSE(nested);
  EXPECT_EQ(nested.error().code, ErrorCode::kInternal);
  const Status in_read = store_.Read([&] { return AppendRobot(store_, kRobot, {1}); });
  ASSERT_FALSE(in_read);
  EXPECT_EQ(in_read.error().code, ErrorCode::kInternal);
  EXPECT_TRUE(store_.Read([&] { return store_.Read([]() -> Status { return {}; }); }));
  EXPECT_TRUE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendRobot(store_, kRobot, {1}));
    return store_.Read([&]() -> Status {
      EXPECT_TRUE(*HasRobot(store_, kRobot));
      return {};
    });
  }));
}

TEST_F(StoreTest, AReaderKeepsItsSnapshotWhileAnotherWrites) {
  Store writer = Open();
  ASSERT_TRUE(AppendRobot(writer, RobotId("r1"), {1}));
  ASSERT_TRUE(store_.Read([&]() -> Status {
    // The snapshot is taken at the start of Read, not at its first query.
    EXPECT_TRUE(AppendRobot(writer, RobotId("r2"), {2}));
    EXPECT_EQ(CountRobots(store_), 1);
    EXPECT_TRUE(writer.Write([&]() -> Status {
      RIGCAL_TRY(AppendRobot(writer, RobotId("r3"), {3}));
      EXPECT_EQ(CountRobots(store_), 1);
      return {};
    }));
    EXPECT_EQ(CountRobots(store_), 1);
    return {};
  }));
  EXPECT_EQ(CountRobots(store_), 3);
}

TEST_F(StoreTest, WhoCannotWaitIsToldThatTheStoreIsBusy) {
  Store writer = Open();
  const auto append = [&] { return AppendRobot(store_, kRobot, {1}); };
  EXPECT_TRUE(writer.Write([&]() -> Status {
    EXPECT_EQ(store_.WriteSoon(append).error().code, ErrorCode::kBusy);
    return {};
  }));
  EXPECT_TRUE(store_.WriteSoon(append));
  EXPECT_TRUE(*HasRobot(store_, kRobot));
  EXPECT_EQ(IsOnSqlite() ? TextIn(store_, "PRAGMA busy_timeout") : "10000", "10000") << "others wait as long as before";
}

TEST_F(StoreTest, TwoWritersTakeTurns) {
  constexpr int kEach = 50;
  std::vector<std::thread> threads;
  for (int t = 0; t < 2; ++t)
    threads.emplace_back([&, t] {
      Store writer = Open();
      for (int i = 0; i < kEach; ++i) EXPECT_TRUE(AppendEdge(writer, MakeEdge(t * kEach + i), {1}));
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), 2 * kEach);
}

}  // namespace
}  // namespace rigcal::storage
