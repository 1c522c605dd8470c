#include "storage/move/source.h"

#include <filesystem>

#include "storage/database/connection.h"
#include "storage/files/blobs.h"
#include "storage/files/folder_lock.h"
#include "storage/files/folders.h"
#include "storage/upkeep/open_unchanged.h"
#include "storage/upkeep/page_check.h"
#include "storage/work/servers.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

Result<FileDescriptor> LockSource(const StorePlace& place) {
  auto locked = HoldFolder(place.folder);
  if (locked || locked.error().code != ErrorCode::kConflict) return locked;
  return Fail(ErrorCode::kConflict, "a rigcald uses the store at " + NameOf(place),
              "Stop it: nothing may come to a store while it is copied.");
}

// What SQLite had already damaged when it read it would be good rows of the copy.
Status RefuseDamagedSource(Store& store) {
  RIGCAL_ASSIGN(const PageLook look, LookAtPages(store.connection(), DatabaseFile(store.folder())));
  if (look.damaged.empty()) return {};
  return Fail(
      ErrorCode::kStorage,
      "the database of " + store.folder().string() + " is damaged at page " + std::to_string(look.damaged.front()),
      "Run `rigcal fsck` on the data folder; nothing was copied.");
}

Result<Source> OpenSqliteSource(const StorePlace& place) {
  std::error_code ignored;
  FileDescriptor lock(-1);
  if (fs::is_regular_file(DatabaseFile(place.folder), ignored)) {
    RIGCAL_ASSIGN(lock, LockSource(place));  // which would make a folder
  }
  RIGCAL_ASSIGN(Store store, OpenUnchanged(place.folder));
  RIGCAL_TRY(RefuseDamagedSource(store));
  return Source{std::move(lock), std::move(store)};
}

}  // namespace

Status RefuseAtWork(Store& store) {
  return store.connection().Load("the store at " + NameOf(store.place()), [&]() -> Status {
    if (!IsAtWork(store.connection())) return {};
    return Fail(ErrorCode::kConflict, "a rigcald or a rigcal-worker uses the store at " + NameOf(store.place()),
                "Stop them, and wait 15 s where one was killed: nothing may come to a store while it is copied.");
  });
}

std::string SourceNameOf(const StorePlace& place) {
  std::error_code failed;
  const fs::path folder = fs::canonical(place.folder, failed);
  return place.server.empty() && !failed ? folder.string() : NameOf(place);
}

Status RefuseBucket(const Store& store) {
  const Status usable = store.blobs().CheckUsable();
  if (usable) return {};
  return Fail(ErrorCode::kUnsupported, usable.error().what + ", and only files in a folder are copied",
              "Let the store stay where it is.");
}

Result<Source> OpenSource(const StorePlace& place) {
  if (place.server.empty()) {
    RIGCAL_ASSIGN(Source source, OpenSqliteSource(place));
    RIGCAL_TRY(RefuseBucket(source.store));
    return source;
  }
  RIGCAL_TRY(CheckServerStore(place));
  RIGCAL_ASSIGN(FileDescriptor lock, LockSource(place));
  RIGCAL_ASSIGN(Store store, Store::Open(place));
  RIGCAL_TRY(RefuseAtWork(store));
  RIGCAL_TRY(RefuseBucket(store));
  return Source{std::move(lock), std::move(store)};
}

Status HoldStill(Store& source, const std::function<Status()>& body) {
  return source.place().server.empty() ? source.Write(body) : source.Read(body);
}

}  // namespace rigcal::storage
