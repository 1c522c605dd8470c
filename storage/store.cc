#include "storage/store.h"

#include <utility>

#include "storage/database/connection.h"
#include "storage/database/open_engine.h"
#include "storage/files/blobs.h"
#include "storage/files/folders.h"
#include "storage/files/room.h"
#include "storage/files/store_id.h"
#include "storage/migrate.h"
#include "storage/s3/store_bucket.h"

namespace rigcal::storage {
namespace fs = std::filesystem;

struct Store::Impl {
  Impl(const StorePlace& where, FileDescriptor mark, std::unique_ptr<Engine> engine)
      : place(where), open_mark(std::move(mark)), connection(std::move(engine), "the store at " + NameOf(where)) {}

  StorePlace place;
  FileDescriptor open_mark;
  Connection connection;
  Blobs blobs{BlobFolderOf(place.folder)};
  int schema_version = 0;
};

namespace {

// Killed before the copy that is to come there had a table: a store made there would pass for the copy.
Status RefuseBegunCopy(Connection& connection, const StorePlace& place) {
  std::error_code ignored;
  if (SchemaVersionOf(connection) != 0 || !fs::exists(UnfinishedMarkOf(place.folder), ignored)) return {};
  return Fail(UnfinishedError(NameOf(place)));
}

bool HoldsFiles(const fs::path& folder) {
  std::error_code failed;
  if (fs::exists(folder / "store-id", failed)) return true;
  for (fs::recursive_directory_iterator at(BlobFolderOf(folder), failed), end; !failed && at != end;
       at.increment(failed))
    if (at->is_regular_file(failed)) return true;
  return false;
}

// A new database beside the files of a store, of PostgreSQL's or of one whose database is gone, would name none of
// them: they would pass for what nobody needs.
Status RefuseFilesOfAnother(Connection& connection, const StorePlace& place) {
  if (!place.server.empty() || SchemaVersionOf(connection) != 0) return {};
  if (!HoldsFiles(place.folder)) return {};
  return Fail(ErrorCode::kConflict,
              "the folder " + place.folder.string() + " holds the files of a store, and its database " +
                  DatabaseFile(place.folder).filename().string() + " is empty or was not there",
              "Give --store postgresql://... if its rows are there; else restore the newest backup into a new folder.");
}

// The version comes first: a store that is not ours to change stays as it is. Its version now.
Result<int> Prepare(Connection& connection, const StorePlace& place) {
  int version = 0;
  RIGCAL_TRY(connection.Load("the store at " + NameOf(place), [&]() -> Status {
    RIGCAL_TRY(CheckVersion(connection, NameOf(place)));
    RIGCAL_TRY(RefuseBegunCopy(connection, place));
    RIGCAL_TRY(RefuseFilesOfAnother(connection, place));
    connection.engine().PrepareDatabase();
    RIGCAL_TRY(Migrate(connection));
    version = SchemaVersionOf(connection);
    return {};
  }));
  return version;
}

}  // namespace

Result<Store> Store::Open(const StorePlace& place) {
  RIGCAL_TRY(MakeFolders(place.folder));
  auto opened = OpenOnce(place);
  if (!place.server.empty()) return opened;
  while (!opened && SpendReserve(place.folder)) opened = OpenOnce(place);
  if (opened || !IsFull(place.folder)) return opened;
  RIGCAL_TRY(ProbeRoom(place.folder));  // says more than SQLite does
  return opened;
}

Result<Store> Store::OpenOnce(const StorePlace& place) {
  std::unique_ptr<Engine> engine;
  // A server that does not answer must not hold up whoever opens the folder, too.
  if (!place.server.empty()) {
    RIGCAL_ASSIGN(engine, OpenEngine(place));
  }
  const FileDescriptor lock = LockOpening(place.folder);
  RIGCAL_ASSIGN(FileDescriptor mark, MarkOpen(place.folder, place.server.empty()));
  if (place.server.empty()) {
    RIGCAL_ASSIGN(engine, OpenEngine(place));
  }
  auto impl = std::make_unique<Impl>(place, std::move(mark), std::move(engine));
  RIGCAL_ASSIGN(impl->schema_version, Prepare(impl->connection, place));
  if (!place.server.empty()) RIGCAL_TRY(TieFolder(impl->connection, place));
  RIGCAL_ASSIGN(impl->blobs, OpenBlobs(impl->connection, place));
  return Store(std::move(impl));
}

Store::Store(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

const StorePlace& Store::place() const { return impl_->place; }
const Blobs& Store::blobs() const { return impl_->blobs; }
fs::path Store::BlobFolder() const { return BlobFolderOf(impl_->place.folder); }
fs::path Store::IntakeFolder() const { return IntakeFolderOf(impl_->place.folder); }
fs::path Store::ReportFolder() const { return ReportFolderOf(impl_->place.folder); }
Status Store::Write(const std::function<Status()>& body) { return impl_->connection.Write(body); }
Status Store::WriteSoon(const std::function<Status()>& body) { return impl_->connection.WriteSoon(body); }
Status Store::Read(const std::function<Status()>& body) { return impl_->connection.Read(body); }
SQLite::Database& Store::database() { return impl_->connection.database(); }
Connection& Store::connection() { return impl_->connection; }
int Store::SchemaVersion() const { return impl_->schema_version; }

}  // namespace rigcal::storage
