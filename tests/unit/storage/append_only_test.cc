// No statement changes or removes what is stored, in any table but the queues, and those that follow from the others.
#include "storage/database/query.h"
#include "tests/unit/storage/fixture.h"
#include "tests/unit/storage/full_store.h"

namespace rigcal::storage {
namespace {

// What tells of the tables and their columns, in either engine.
const std::string kTables = IsOnSqlite()
                                ? "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite%'"
                                : "SELECT CAST(tablename AS TEXT) AS name FROM pg_tables WHERE schemaname = 'rigcal' "
                                  "AND tablename <> 'schema_version'";
const std::string kRealColumns =
    IsOnSqlite()
        ? "SELECT m.name || '.' || c.name FROM sqlite_schema m JOIN pragma_table_info(m.name) c WHERE m.type = 'table' "
          "AND c.type = 'REAL'"
        : "SELECT table_name || '.' || column_name FROM information_schema.columns WHERE table_schema = 'rigcal' AND "
          "data_type = 'double precision'";

std::string FirstColumnOf(Store& store, const std::string& table) {
  if (IsOnSqlite()) return ColumnIn(store, "SELECT name FROM pragma_table_info('" + table + "')").front();
  return TextIn(store,
                "SELECT CAST(column_name AS TEXT) FROM information_schema.columns WHERE table_schema = 'rigcal' AND "
                "table_name = '" +
                    table + "' ORDER BY ordinal_position LIMIT 1");
}

// Whether the database refuses the statement.
bool IsRefused(Store& store, const std::string& sql) {
  return !store.connection().Append("a table", [&]() -> Status {
    Query(store, sql).Run();
    return {};
  });
}

class AppendOnlyTest : public StoreTest {
 protected:
  void SetUp() override { FillEveryTable(store_); }
};

TEST_F(AppendOnlyTest, EveryTableButTheQueues) {
  const std::vector<std::string> tables =
      ColumnIn(store_, "SELECT name FROM (" + kTables +
                           ") t WHERE name NOT LIKE 'waiting%' AND name NOT LIKE 'merge_state%' AND name NOT LIKE "
                           "'summary%' AND name NOT LIKE 'login%' AND name NOT LIKE 'lease%'");
  EXPECT_GE(tables.size(), 20u);
  for (const std::string& table : tables) {
    EXPECT_NE(IntIn(store_, "SELECT count(*) FROM " + table), 0) << table << " is not put to the test";
    const std::string first = FirstColumnOf(store_, table);
    EXPECT_TRUE(IsRefused(store_, "DELETE FROM " + table)) << table;
    EXPECT_TRUE(IsRefused(store_, "UPDATE " + table + " SET " + first + " = " + first)) << table;
    const std::string again =
        IsOnSqlite() ? "INSERT OR REPLACE INTO " + table + " SELECT * FROM " + table : "TRUNCATE " + table + " CASCADE";
    EXPECT_TRUE(IsRefused(store_, again)) << table;
  }
}

TEST_F(AppendOnlyTest, AClosedSessionTakesNoMorePayloads) {
  const std::string digest(64, 'a');
  EXPECT_TRUE(IsRefused(store_, "INSERT INTO payload VALUES (1, 2, 'left/x.png', '" + digest + "', 5)"));
}

TEST_F(AppendOnlyTest, UnitsAreTheEndOfColumnNames) {
  const std::vector<std::string> reals = ColumnIn(store_, kRealColumns);
  ASSERT_FALSE(reals.empty());
  for (const std::string& name : reals) {
    const bool unitless = name.find("_q") != std::string::npos || name == "edge_figure.value" ||
                          name == "edge_capture.rms" || name.ends_with("_dof");
    const std::vector<std::string> units = {"_m", "_rad", "_m2", "_rad2", "_ratio"};
    EXPECT_TRUE(unitless ||
                std::any_of(units.begin(), units.end(), [&](const auto& unit) { return name.ends_with(unit); }))
        << name;
  }
}

}  // namespace
}  // namespace rigcal::storage
