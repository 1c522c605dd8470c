#include "storage/store.h"

#include <utility>

#include "storage/database/connection.h"
#include "storage/database/sqlite_engine.h"
#include "storage/files/folders.h"
#include "storage/files/room.h"
#include "storage/migrate.h"

namespace rigcal::storage {
namespace fs = std::filesystem;

namespace {

std::string NameOf(const fs::path& folder) { return "the store at " + folder.string(); }

}  // namespace

struct Store::Impl {
  Impl(const fs::path& path, FileDescriptor mark)
      : folder(path), open_mark(std::move(mark)), connection(DatabaseFile(path), NameOf(path)) {}

  fs::path folder;
  FileDescriptor open_mark;
  Connection connection;
  int schema_version = 0;
};

namespace {

// The version comes first: a store that is not ours to change stays as it is. Its version now.
Result<int> Prepare(Connection& connection, const fs::path& folder) {
  int version = 0;
  RIGCAL_TRY(connection.Load(NameOf(folder), [&]() -> Status {
    RIGCAL_TRY(CheckVersion(connection, folder.string()));
    connection.engine().PrepareDatabase();
    RIGCAL_TRY(Migrate(connection));
    version = SchemaVersionOf(connection);
    return {};
  }));
  return version;
}

}  // namespace

Result<Store> Store::Open(const fs::path& folder) {
  RIGCAL_TRY(MakeFolders(folder));
  auto opened = OpenOnce(folder);
  while (!opened && SpendReserve(folder)) opened = OpenOnce(folder);
  if (opened || !IsFull(folder)) return opened;
  RIGCAL_TRY(ProbeRoom(folder));  // says more than SQLite does
  return opened;
}

Result<Store> Store::OpenOnce(const fs::path& folder) {
  const FileDescriptor lock = LockOpening(folder);
  RIGCAL_ASSIGN(FileDescriptor mark, MarkOpen(folder));
  try {
    auto impl = std::make_unique<Impl>(folder, std::move(mark));
    RIGCAL_ASSIGN(impl->schema_version, Prepare(impl->connection, folder));
    return Store(std::move(impl));
  } catch (const SQLite::Exception& failure) {
    return Fail(ErrorOf(failure, NameOf(folder)));
  }
}

Store::Store(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;
Store& Store::operator=(Store&&) noexcept = default;

const fs::path& Store::folder() const { return impl_->folder; }
fs::path Store::BlobFolder() const { return BlobFolderOf(impl_->folder); }
fs::path Store::IntakeFolder() const { return IntakeFolderOf(impl_->folder); }
fs::path Store::ReportFolder() const { return ReportFolderOf(impl_->folder); }
Status Store::Write(const std::function<Status()>& body) { return impl_->connection.Write(body); }
Status Store::WriteSoon(const std::function<Status()>& body) { return impl_->connection.WriteSoon(body); }
Status Store::Read(const std::function<Status()>& body) { return impl_->connection.Read(body); }
SQLite::Database& Store::database() { return impl_->connection.database(); }
Connection& Store::connection() { return impl_->connection; }
int Store::SchemaVersion() const { return impl_->schema_version; }

}  // namespace rigcal::storage
