// A store that was moved to the other engine is the same store.
#include <algorithm>
#include <cctype>
#include <set>

#include "server/formats/documents.h"
#include "storage/revisions/revisions.h"
#include "tests/unit/move/fixture.h"

namespace rigcal::storage {
namespace {

using testing::HasSubstr;

// What tells of the tables and columns of a database, in either engine.
std::vector<std::string> ColumnsIn(Store& store) {
  return ColumnIn(
      store,
      store.place().server.empty()
          ? "SELECT lower(m.name || '.' || c.name) AS name FROM sqlite_schema m JOIN pragma_table_info(m.name) c "
            "WHERE m.type = 'table' AND m.name NOT LIKE 'sqlite%' AND m.name NOT LIKE 'lease%' ORDER BY 1"
          : "SELECT CAST(table_name || '.' || column_name AS TEXT) COLLATE \"C\" FROM information_schema.columns c "
            "JOIN pg_tables t ON t.schemaname = 'rigcal' AND t.tablename = c.table_name "
            "WHERE table_schema = 'rigcal' AND table_name <> 'schema_version' AND "
            "table_name NOT LIKE 'lease%' AND column_name <> 'rowid' ORDER BY 1");
}

std::vector<std::string> ColumnsOfSchema() {
  std::vector<std::string> columns;
  const auto tables = LoadSchemaTables().value();
  for (const SchemaTable& table : tables)
    for (const SchemaColumn& column : table.columns) {
      std::string name = table.name + "." + column.name;
      for (char& c : name) c = static_cast<char>(std::tolower(c));
      if (column.name != "rowid") columns.push_back(name);
    }
  std::sort(columns.begin(), columns.end());
  return columns;
}

void PushOnce(Store store, std::size_t payloads) { Push(store, payloads); }
void CalibrateOnce(Store store) { Calibrate(store, Push(store, 4)); }

TEST_F(MoveTest, KnowsEveryColumnOfTheDatabase) {
  FillStore();
  ASSERT_EQ(WordsOf(Move()), "good");
  Store original = Store::Open(from()).value(), copy = Store::Open(to()).value();
  EXPECT_EQ(ColumnsIn(original), ColumnsOfSchema());
  EXPECT_EQ(ColumnsIn(copy), ColumnsOfSchema());
}

TEST_F(MoveTest, EachTableComesAfterThoseThatItRefersTo) {
  std::set<std::string> before;
  const auto tables = LoadSchemaTables().value();
  for (const SchemaTable& table : tables) {
    for (const std::string& other : table.refers_to) EXPECT_TRUE(before.count(other)) << table.name << ", " << other;
    before.insert(table.name);
    EXPECT_FALSE(table.key.empty()) << table.name;
  }
  EXPECT_GE(tables.size(), 70u);
}

TEST_F(MoveTest, EveryRowIsThere) {
  FillStore();
  const auto moved = Move();
  ASSERT_TRUE(moved) << WordsOf(moved);
  Store original = Store::Open(from()).value(), copy = Store::Open(to()).value();
  const auto counts = CountsOf(copy);
  EXPECT_EQ(counts, CountsOf(original));
  std::int64_t rows = 0;
  for (const auto& [table, count] : counts) {
    rows += count;
    const bool is_queue =
        table.rfind("waiting", 0) == 0 || table.rfind("login", 0) == 0 || table.rfind("merge_state", 0) == 0;
    EXPECT_TRUE(count > 0 || is_queue || table.rfind("summary", 0) == 0) << table << " is not put to the test";
  }
  EXPECT_EQ(moved->rows, rows);
  EXPECT_EQ(moved->tables, static_cast<std::int64_t>(counts.size()));
  EXPECT_FALSE(moved->went_on);
}

TEST_F(MoveTest, IdsDocumentsAndDigestsAreTheSame) {
  FillStore();
  ASSERT_EQ(WordsOf(Move()), "good");
  Store original = Store::Open(from()).value(), copy = Store::Open(to()).value();
  for (const char* sql :
       {"SELECT session_id FROM session ORDER BY number", "SELECT manifest FROM session ORDER BY number",
        "SELECT edge_id FROM edge ORDER BY number", "SELECT digest FROM revision ORDER BY robot_id, number",
        "SELECT digest FROM payload ORDER BY session_number, idx", "SELECT rowid FROM revision ORDER BY 1"})
    EXPECT_EQ(ColumnIn(copy, sql), ColumnIn(original, sql)) << sql;
  const auto revision = LoadRevision(copy, kRobot, 1).value().value();
  EXPECT_EQ(revision.document, LoadRevision(original, kRobot, 1).value()->document);
  EXPECT_EQ(DigestOf(revision.document), revision.digest);
  const EdgeId edge(TextIn(original, "SELECT edge_id FROM edge WHERE number = 1"));
  EXPECT_EQ(formats::WriteEdge(LoadEdge(copy, edge).value().value()),
            formats::WriteEdge(LoadEdge(original, edge).value().value()));
}

TEST_F(MoveTest, TheAuditHolds) {
  FillStore();
  ASSERT_EQ(WordsOf(Move()), "good");
  Store copy = Store::Open(to()).value();
  const auto audit = VerifyAudit(copy).value();
  EXPECT_FALSE(audit.fault);
  EXPECT_TRUE(audit.row_faults.empty());
  EXPECT_GT(IntIn(copy, "SELECT count(*) FROM audit_row"), 0);
}

TEST_F(MoveTest, NothingIsDamagedInEither) {
  CalibrateOnce(Open());
  ASSERT_EQ(WordsOf(Move()), "good");
  EXPECT_EQ(Check()->unmended(), 0);
  if (!IsOnSqlite()) return;
  const auto checked = Fsck({to().folder}, SystemClock());
  EXPECT_EQ(checked->unmended(), 0);
  EXPECT_EQ(checked->pages_unknown, 0);
}

TEST_F(MoveTest, FilesAreLinksThatTheCopyFinds) {
  FillStore();
  const auto moved = Move();
  ASSERT_TRUE(moved) << WordsOf(moved);
  EXPECT_EQ(moved->copied_bytes, 0);
  EXPECT_EQ(moved->files, 3 * 7);  // what FillEveryTable names was never there
  EXPECT_FALSE(moved->lost.empty());
  const RobotId robot("mapper-02");
  Store copy = Store::Open(to()).value();
  EXPECT_EQ(LoadBlob(copy.BlobFolder(), DigestOf(ContentOf(6, robot)), 100).value(), ContentOf(6, robot));
  EXPECT_EQ(fs::hard_link_count(BlobPath(copy.BlobFolder(), DigestOf(ContentOf(6, robot)))), 2u);
}

TEST_F(MoveTest, CopiesFilesWhereThatIsAsked) {
  PushOnce(Open(), 3);
  MoveOptions words = options();
  words.how = CopyHow::kCopy;
  EXPECT_EQ(MoveStore(words)->copied_bytes, static_cast<std::int64_t>(3 * ContentOf(0).size()));
}

TEST_F(MoveTest, TheCopyGoesOnAsTheStoreWouldHave) {
  FillStore();
  ASSERT_EQ(WordsOf(Move()), "good");
  const auto go_on = [](Store store) {
    Push(store, 9, RobotId("newcomer"));
    EXPECT_FALSE(store.Write([&]() -> Status {
      Query(store, "DELETE FROM audit").Run();
      return {};
    })) << "append-only no longer";
    return std::pair{ColumnIn(store, "SELECT CAST(number AS TEXT) || session_id FROM session ORDER BY number"),
                     CountsOf(store)};
  };
  EXPECT_EQ(go_on(Store::Open(to()).value()), go_on(Store::Open(from()).value()));
}

TEST_F(MoveTest, ComesBackToSqliteAsItWas) {
  FillStore();
  ASSERT_EQ(WordsOf(Move()), "good");
  MoveOptions back;
  back.from = to(), back.to = folder_.path() / "back";
  ASSERT_EQ(WordsOf(MoveStore(back)), "good");
  EXPECT_EQ(Fsck({folder_.path() / "back"}, SystemClock())->unmended(), Check()->unmended());
  Store original = Store::Open(from()).value(), again = Store::Open(folder_.path() / "back").value();
  EXPECT_EQ(CountsOf(again), CountsOf(original));
}

TEST_F(MoveTest, NamesWhatTheStoreHasLost) {
  PushOnce(Open(), 5);
  FlipByte(BlobOf(ContentOf(2)), 3);
  const auto moved = Move();
  ASSERT_TRUE(moved) << WordsOf(moved);
  ASSERT_EQ(moved->lost.size(), 1u);
  EXPECT_THAT(moved->lost[0], HasSubstr(kRobot.str()));
  EXPECT_EQ(moved->files, 4);
}

}  // namespace
}  // namespace rigcal::storage
