#include "storage/database/open_engine.h"

#include "storage/database/sqlite_engine.h"
#include "storage/files/folders.h"
#include "storage/postgres/postgres_engine.h"

namespace rigcal::storage {

Result<std::unique_ptr<Engine>> OpenEngine(const StorePlace& place) {
  const std::string subject = "the store at " + NameOf(place);
  try {
    if (place.server.empty()) return std::make_unique<SqliteEngine>(DatabaseFile(place.folder));
    return std::make_unique<PostgresEngine>(place.server);
  } catch (const SQLite::Exception& failure) {
    return Fail(ErrorOf(failure, subject));
  } catch (const PostgresFailure& failure) {
    return Fail(ErrorOf(failure, subject));
  }
}

}  // namespace rigcal::storage
