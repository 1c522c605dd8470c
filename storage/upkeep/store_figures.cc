#include "storage/upkeep/store_figures.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include <vector>

#include "storage/database/connection.h"

namespace rigcal::storage {
namespace {

std::vector<std::string> TablesOf(SQLite::Database& database) {
  std::vector<std::string> names;
  SQLite::Statement query(
      database, "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' ORDER BY name");
  while (query.executeStep()) names.push_back(query.getColumn(0).getString());
  return names;
}

}  // namespace

Result<StoreFigures> LoadFigures(Store& store) {
  if (!store.place().server.empty())
    return Fail(ErrorCode::kUnsupported, "the rows are in PostgreSQL", "Ask that for its sizes.");
  StoreFigures figures;
  figures.schema_version = store.SchemaVersion();
  RIGCAL_TRY(store.Read([&] {
    return store.connection().Load("the sizes of tables", [&]() -> Status {
      for (const std::string& name : TablesOf(store.database()))
        figures.rows[name] = store.database().execAndGet("SELECT count(*) FROM \"" + name + "\"").getInt64();
      return {};
    });
  }));
  return figures;
}

}  // namespace rigcal::storage
