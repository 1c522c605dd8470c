#include "storage/move/schema_tables.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include <algorithm>
#include <map>

#include "storage/database/sqlite_engine.h"
#include "storage/migrate.h"

namespace rigcal::storage {
namespace {

const std::map<std::string, ColumnKind> kColumnKinds = {{"INTEGER", ColumnKind::kWhole},
                                                        {"REAL", ColumnKind::kReal},
                                                        {"TEXT", ColumnKind::kText},
                                                        {"BLOB", ColumnKind::kBytes}};

// The schema of today in a database that is nowhere.
SQLite::Database EmptyDatabase() {
  SQLite::Database database(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  for (const std::string_view file : SchemaTexts()) database.exec(std::string(file));
  return database;
}

std::vector<std::string> NamesFrom(SQLite::Database& database, const std::string& sql, const std::string& table) {
  SQLite::Statement query(database, sql);
  if (query.getBindParameterCount() > 0) query.bind(1, table);
  std::vector<std::string> names;
  while (query.executeStep()) names.push_back(query.getColumn(0).getString());
  return names;
}

std::size_t PlaceOf(const SchemaTable& table, const std::string& column) {
  const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const SchemaColumn& one) { return one.name == column; });
  return static_cast<std::size_t>(found - table.columns.begin());
}

Status AddColumns(SQLite::Database& database, SchemaTable& table) {
  SQLite::Statement query(database, "SELECT name, type FROM pragma_table_info(?) ORDER BY cid");
  query.bind(1, table.name);
  while (query.executeStep()) {
    const auto kind = kColumnKinds.find(query.getColumn(1).getString());
    const std::string name = query.getColumn(0).getString();
    if (kind == kColumnKinds.end())
      return Fail(ErrorCode::kInternal, "column " + name + " of the table " + table.name + " has an unknown type",
                  "This is a fault of rigcal: please report it.");
    table.columns.push_back({name, kind->second});
  }
  return {};
}

// What SQLite keeps rows by: a whole number that is the key, the key of a table WITHOUT ROWID, or else the rowid.
void AddKey(SQLite::Database& database, SchemaTable& table) {
  const auto key = NamesFrom(database, "SELECT name FROM pragma_table_info(?) WHERE pk > 0 ORDER BY pk", table.name);
  const bool has_rowid = !NamesFrom(database, "SELECT name FROM pragma_table_list(?) WHERE wr = 0", table.name).empty();
  const bool is_its_rowid = key.size() == 1 && table.columns[PlaceOf(table, key[0])].kind == ColumnKind::kWhole;
  if (has_rowid && !is_its_rowid) {
    table.columns.insert(table.columns.begin(), {"rowid", ColumnKind::kWhole});
    table.key = {0};
    return;
  }
  for (const std::string& column : key) table.key.push_back(PlaceOf(table, column));
}

Result<SchemaTable> LoadTable(SQLite::Database& database, const std::string& name) {
  SchemaTable table;
  table.name = name;
  RIGCAL_TRY(AddColumns(database, table));
  AddKey(database, table);
  table.refers_to = NamesFrom(database, R"(SELECT DISTINCT "table" FROM pragma_foreign_key_list(?))", name);
  return table;
}

bool IsPlacedAfter(const SchemaTable& table, const std::vector<SchemaTable>& placed) {
  return std::all_of(table.refers_to.begin(), table.refers_to.end(), [&](const std::string& other) {
    return other == table.name ||
           std::any_of(placed.begin(), placed.end(), [&](const SchemaTable& one) { return one.name == other; });
  });
}

Result<std::vector<SchemaTable>> InOrder(std::vector<SchemaTable> tables) {
  std::vector<SchemaTable> placed;
  while (!tables.empty()) {
    const auto next =
        std::find_if(tables.begin(), tables.end(), [&](const SchemaTable& one) { return IsPlacedAfter(one, placed); });
    if (next == tables.end())
      return Fail(ErrorCode::kInternal, "the table " + tables.front().name + " refers to others in a circle",
                  "This is a fault of rigcal: please report it.");
    placed.push_back(std::move(*next));
    tables.erase(next);
  }
  return placed;
}

}  // namespace

std::vector<std::string> SchemaTable::ColumnNames() const {
  std::vector<std::string> names;
  for (const SchemaColumn& column : columns) names.push_back(column.name);
  return names;
}

Result<std::vector<SchemaTable>> LoadSchemaTables() {
  constexpr const char* kTables =
      "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite%' AND name NOT LIKE 'lease\\_%' "
      "ESCAPE '\\' ORDER BY name";
  try {
    SQLite::Database database = EmptyDatabase();
    std::vector<SchemaTable> tables;
    for (const std::string& name : NamesFrom(database, kTables, "")) {
      RIGCAL_ASSIGN(SchemaTable table, LoadTable(database, name));
      tables.push_back(std::move(table));
    }
    return InOrder(std::move(tables));
  } catch (const SQLite::Exception& failure) {
    return Fail(ErrorOf(failure, "the tables of the schema"));
  }
}

}  // namespace rigcal::storage
