#include "storage/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <system_error>
#include <utility>

#include "server/base/durable_file.h"
#include "storage/blobs.h"
#include "storage/connection.h"
#include "storage/migrate.h"

namespace rigcal::storage {
namespace fs = std::filesystem;

struct Store::Impl {
  fs::path folder;
  Connection connection;
  int schema_version = 0;
};

namespace {

constexpr const char* kDatabaseFile = "rigcal.db";
constexpr const char* kBlobs = "blobs";
constexpr const char* kIntake = "intake";
constexpr const char* kReports = "reports";

std::string NameOf(const fs::path& folder) { return "the store at " + folder.string(); }

Status MakeFolder(const fs::path& folder) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (!code && fs::is_directory(folder, code)) return {};
  return Fail(ErrorCode::kStorage, "cannot make the folder " + folder.string() + (code ? ": " + code.message() : ""),
              "Check that the folder above it exists and that this user may write to it.");
}

// While it lives, no other Store opens this folder: switching a new database to WAL does not wait for its turn.
class OpeningLock {
 public:
  explicit OpeningLock(const fs::path& folder) : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (file_ >= 0) flock(file_, LOCK_EX);
  }
  ~OpeningLock() {
    if (file_ >= 0) close(file_);
  }
  OpeningLock(const OpeningLock&) = delete;
  OpeningLock& operator=(const OpeningLock&) = delete;

 private:
  int file_;
};

// A shard folder that was made, or a blob that was moved, just before the process died is made durable here: whatever
// is in sight after Open survives power loss.
Status MakeSubfolders(const fs::path& folder) {
  for (const char* name : {kBlobs, kIntake, kReports}) RIGCAL_TRY(MakeFolder(folder / name));
  RIGCAL_TRY(SyncFolder(folder));
  for (int shard = 0; shard < 256; ++shard) RIGCAL_TRY(MakeFolder(ShardFolder(folder / kBlobs, shard)));
  RIGCAL_TRY(SyncFolder(folder / kBlobs));
  for (int shard = 0; shard < 256; ++shard) RIGCAL_TRY(SyncFolder(ShardFolder(folder / kBlobs, shard)));
  return {};
}

// The version comes first: a store that is not ours to change stays as it is.
Status Prepare(Connection& connection, const fs::path& folder) {
  RIGCAL_TRY(CheckVersion(connection, folder.string()));
  connection.database().execAndGet("PRAGMA journal_mode = WAL");
  return Migrate(connection);
}

}  // namespace

Result<Store> Store::Open(const fs::path& folder) {
  RIGCAL_TRY(MakeFolder(folder));
  const OpeningLock lock(folder);
  try {
    auto impl = std::make_unique<Impl>(folder, Connection(folder / kDatabaseFile, NameOf(folder)));
    RIGCAL_TRY(Prepare(impl->connection, folder));
    impl->schema_version = SchemaVersionOf(impl->connection);
    RIGCAL_TRY(MakeSubfolders(folder));
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
fs::path Store::BlobFolder() const { return impl_->folder / kBlobs; }
fs::path Store::IntakeFolder() const { return impl_->folder / kIntake; }
fs::path Store::ReportFolder() const { return impl_->folder / kReports; }
Status Store::Write(const std::function<Status()>& body) { return impl_->connection.Write(body); }
Status Store::Read(const std::function<Status()>& body) { return impl_->connection.Read(body); }
SQLite::Database& Store::database() { return impl_->connection.database(); }
Connection& Store::connection() { return impl_->connection; }
int Store::SchemaVersion() const { return impl_->schema_version; }

}  // namespace rigcal::storage
