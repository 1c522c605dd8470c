#include "storage/move/unfinished_copy.h"

#include <filesystem>

#include "server/base/files/durable_file.h"
#include "storage/database/open_engine.h"
#include "storage/database/query.h"
#include "storage/files/folder_lock.h"
#include "storage/files/folders.h"
#include "storage/files/store_id.h"
#include "storage/migrate.h"
#include "storage/upkeep/copy_verified.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMarkBytesMax = 8192;

std::string MarkText(const std::string& source, const StorePlace& place) {
  return source + "\n" + NameOf(place) + "\n";
}

// Beside what a process leaves that was killed before it marked the folder.
bool IsEmptyFolder(const fs::path& folder) {
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name != "lock" && name.rfind(UnfinishedMarkOf(folder).filename().string(), 0) != 0) return false;
  }
  return true;
}

// Whether the folder is that of this copy; what may become it is not.
Result<bool> LookAtFolder(const StorePlace& place, const std::string& source) {
  std::error_code ignored;
  const fs::path mark = UnfinishedMarkOf(place.folder);
  if (fs::exists(mark, ignored)) {
    RIGCAL_ASSIGN(const std::string text, ReadFile(mark, kMarkBytesMax));
    if (text == MarkText(source, place)) return true;
    return Fail(ErrorCode::kConflict,
                "the folder " + place.folder.string() + " is that of the unfinished copy of " +
                    text.substr(0, text.find('\n')) + ", or of one in another database",
                "Give the store and the database that it was begun with, or a new folder.");
  }
  if (!fs::exists(place.folder, ignored) || (fs::is_directory(place.folder, ignored) && IsEmptyFolder(place.folder)))
    return false;
  return Fail(ErrorCode::kConflict, "the folder " + place.folder.string() + " is not empty",
              "Give a new one: the copy has files of its own.");
}

}  // namespace

Error TakenError(const StorePlace& place) {
  return {ErrorCode::kConflict, "there is a store at " + NameOf(place) + " already",
          "Give a database that has none: what is in one is never overwritten."};
}

Result<UnfinishedCopy> UnfinishedCopy::Open(const StorePlace& place, const std::string& source,
                                            const std::vector<SchemaTable>& tables) {
  std::vector<std::string> names;
  for (const SchemaTable& table : tables) names.push_back(table.name);
  UnfinishedCopy copy(place, source, std::move(names));
  RIGCAL_ASSIGN(const bool folder_is_ours, LookAtFolder(place, source));
  if (!place.server.empty()) {
    RIGCAL_TRY(copy.OpenDatabase());
    RIGCAL_TRY(copy.LookAtDatabase(folder_is_ours));
  }
  RIGCAL_TRY(copy.MakeFolder());
  if (place.server.empty()) {
    RIGCAL_TRY(copy.OpenDatabase());
    RIGCAL_TRY(copy.LookAtDatabase(true));
  }
  if (!copy.is_there_) RIGCAL_TRY(copy.MakeTables());
  if (!place.server.empty()) RIGCAL_TRY(copy.Tie());
  return copy;
}

Status UnfinishedCopy::OpenDatabase() {
  RIGCAL_ASSIGN(auto engine, OpenEngine(place_));
  connection_ = std::make_unique<Connection>(std::move(engine), "the store at " + NameOf(place_));
  return {};
}

Status UnfinishedCopy::LookAtDatabase(bool folder_is_ours) {
  return connection_->Load("the store at " + NameOf(place_), [&]() -> Status {
    const SchemaState state = connection_->engine().LoadSchemaState();
    if (state.version > kUnfinishedVersion) return LookAtCopy(folder_is_ours);
    RIGCAL_TRY(CheckVersion(*connection_, NameOf(place_)));
    if (!state.is_ours) return {};
    if (!folder_is_ours) return Fail(TakenError(place_));
    is_there_ = is_finished_ = true;  // Tie() tells whether it is the folder's
    return {};
  });
}

Status UnfinishedCopy::LookAtCopy(bool folder_is_ours) {
  if (SchemaVersionOf(*connection_) != kUnfinishedVersion + NewestSchemaVersion())
    return Fail(ErrorCode::kUnsupported, "the copy at " + NameOf(place_) + " was begun by another version of rigcal",
                "Go on with that one, or remove the copy and begin anew.");
  Query query(*connection_, "SELECT source, fingerprint FROM unfinished_copy");
  if (!query.Step() || query.Text(0) != source_ || !folder_is_ours)
    return Fail(ErrorCode::kConflict,
                "at " + NameOf(place_) + " is an unfinished copy of another store, or of this one with another folder",
                "Give the store and the folder that it was begun with, or another database.");
  is_there_ = true;
  if (!query.IsNull(1)) fingerprint_ = query.IdAt<Digest>(1);
  return {};
}

Status UnfinishedCopy::MakeFolder() {
  auto locked = HoldFolder(place_.folder);
  if (!locked && locked.error().code == ErrorCode::kConflict)
    return Fail(ErrorCode::kConflict, "another process uses the folder " + place_.folder.string(),
                "Wait until it has ended, or stop it.");
  if (!locked) return Fail(locked.error());
  lock_ = *std::move(locked);
  RIGCAL_TRY(WriteDurably(UnfinishedMarkOf(place_.folder), MarkText(source_, place_)));
  return MakeFolders(place_.folder);
}

Status UnfinishedCopy::MakeTables() {
  return connection_->Load("the store at " + NameOf(place_), [&]() -> Status {
    Engine& engine = connection_->engine();
    engine.PrepareDatabase();
    return connection_->Write([&]() -> Status {
      RunMissingSchema(*connection_);
      engine.Empty(tables_);  // some have a row from the beginning
      Query(*connection_, "CREATE TABLE unfinished_copy (source TEXT NOT NULL, fingerprint TEXT)").Run();
      Query(*connection_, "INSERT INTO unfinished_copy VALUES (?, NULL)").Bind(source_).Run();
      engine.NoteSchemaVersion(kUnfinishedVersion + NewestSchemaVersion());
      return {};
    });
  });
}

// An id in the folder that the database has not is of a process that was killed between the two.
Status UnfinishedCopy::Tie() {
  bool is_tied = false;
  RIGCAL_TRY(connection_->Load("the store at " + NameOf(place_), [&]() -> Status {
    is_tied = Query(*connection_, "SELECT store_id FROM lease_folder").Step();
    return {};
  }));
  std::error_code ignored;
  if (!is_tied) fs::remove(place_.folder / "store-id", ignored);
  return TieFolder(*connection_, place_);
}

Status UnfinishedCopy::BeginAnew(const Digest& fingerprint) {
  return connection_->Append("the store at " + NameOf(place_), [&]() -> Status {
    connection_->engine().Empty(tables_);
    Query(*connection_, "UPDATE unfinished_copy SET fingerprint = ?").Bind(fingerprint).Run();
    fingerprint_ = fingerprint;
    return {};
  });
}

Status UnfinishedCopy::Finish() {
  if (!is_finished_) {
    RIGCAL_TRY(SyncFileSystem(place_.folder));
    RIGCAL_TRY(connection_->Append("the store at " + NameOf(place_), [&]() -> Status {
      Query(*connection_, "DROP TABLE unfinished_copy").Run();
      connection_->engine().NoteSchemaVersion(NewestSchemaVersion());
      return {};
    }));
  }
  std::error_code ignored;
  fs::remove(UnfinishedMarkOf(place_.folder), ignored);
  return {};
}

}  // namespace rigcal::storage
