#include "storage/upkeep/open_unchanged.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <unistd.h>

#include <cerrno>

#include "storage/database/connection.h"
#include "storage/database/log_damage.h"
#include "storage/database/open_engine.h"
#include "storage/database/sqlite_engine.h"
#include "storage/database/summing_files.h"
#include "storage/files/folders.h"
#include "storage/migrate.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

// By a connection that cannot write.
Result<int> VersionOf(const fs::path& database) {
  try {
    const bool is_fixed = CannotChange(database);
    SQLite::Database reader(is_fixed ? UnchangingName(database) : database.string(),
                            SQLite::OPEN_READONLY | (is_fixed ? SQLite::OPEN_URI : 0), 10'000, SummingFiles());
    return reader.execAndGet("PRAGMA user_version").getInt();
  } catch (const SQLite::Exception& failure) {
    return Fail(ErrorOf(failure, database.string()));
  }
}

// To read a database with a log SQLite writes beside it.
Status RefuseUnwritable(const fs::path& folder) {
  if (access(folder.c_str(), W_OK) == 0) return {};
  const bool is_read_only = errno == EROFS;
  if (is_read_only && CannotChange(DatabaseFile(folder))) return {};
  if (is_read_only)
    return Fail(ErrorCode::kUnsupported,
                "the folder " + folder.string() +
                    " is read-only, and rigcal.db-wal there may have changes that are not " + "yet in rigcal.db",
                "Mount it writable, or copy all of the folder (`cp -a`) and give the copy.");
  return Fail(ErrorCode::kUnsupported,
              "this user may not write to the folder " + folder.string() + ", which reading its database needs",
              "Run it as the user whose folder it is, or copy all of the folder and give the copy.");
}

}  // namespace

Status CheckServerStore(const StorePlace& place) {
  const std::string name = NameOf(place);
  RIGCAL_ASSIGN(auto engine, OpenEngine(place));
  Connection connection(std::move(engine), "the store at " + name);
  return connection.Load("the store at " + name, [&]() -> Status {
    RIGCAL_TRY(CheckVersion(connection, name));
    const int version = SchemaVersionOf(connection);
    if (version == NewestSchemaVersion()) return {};
    if (version == 0)
      return Fail(ErrorCode::kNotFound, "there is no store at " + name, "Give the database of a rigcald.");
    return Fail(ErrorCode::kUnsupported,
                "the store at " + name + " has schema version " + std::to_string(version) + ", this rigcal has " +
                    std::to_string(NewestSchemaVersion()),
                "Use the rigcal that was installed with its rigcald, or start this version's rigcald on it once.");
  });
}

Result<Store> OpenUnchanged(const StorePlace& place) {
  if (place.server.empty()) return OpenUnchanged(place.folder);
  std::error_code failed;
  if (!fs::is_directory(BlobFolderOf(place.folder), failed))
    return Fail(ErrorCode::kNotFound, place.folder.string() + " holds no files of a store: there is no folder blobs",
                "Give the folder that `rigcald --data` has.");
  RIGCAL_TRY(CheckServerStore(place));
  return Store::Open(place);
}

Result<Store> OpenUnchanged(const fs::path& folder) {
  std::error_code failed;
  if (!fs::exists(DatabaseFile(folder), failed) && fs::is_directory(BlobFolderOf(folder), failed))
    return Fail(ErrorCode::kUnsupported,
                folder.string() + " holds the files of a store, but not its rows: those are in PostgreSQL",
                "To copy it use pg_dump for the rows, and then copy the folder blobs; `rigcal fsck` takes --store.");
  if (!fs::is_regular_file(DatabaseFile(folder), failed))
    return Fail(ErrorCode::kNotFound, folder.string() + " holds no store: there is no rigcal.db",
                "Give the folder that `rigcald --data` has.");
  RIGCAL_TRY(RefuseUnwritable(folder));
  RIGCAL_TRY(RefuseDamagedLog(folder));
  RIGCAL_ASSIGN(const int version, VersionOf(DatabaseFile(folder)));
  if (version > kUnfinishedVersion) return Fail(UnfinishedError(folder.string()));
  if (version != NewestSchemaVersion())
    return Fail(ErrorCode::kUnsupported,
                "the store at " + folder.string() + " has schema version " + std::to_string(version) +
                    ", this rigcal has " + std::to_string(NewestSchemaVersion()),
                "Use the rigcal that was installed with its rigcald, or start this version's rigcald on it once.");
  return Store::Open(folder);
}

}  // namespace rigcal::storage
