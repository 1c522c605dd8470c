#include "server/pipeline/answers/health.h"

#include "storage/database/refused_pages.h"
#include "storage/files/folders.h"
#include "storage/files/room.h"

namespace rigcal::pipeline {
namespace {

constexpr std::chrono::seconds kLookAgain{1};

Status CheckDatabase(storage::Store& store) {
  RIGCAL_TRY(store.Read([]() -> Status { return {}; }));
  return storage::CheckNoneRefused(storage::DatabaseFile(store.folder()));
}

}  // namespace

// Both are looked at only when somebody asks: in between they rest.
ServerHealth::ServerHealth(std::filesystem::path folder, const Clock& clock)
    : folder_(std::move(folder)),
      vitals_(clock),
      disk_(vitals_.Expect("disk", kLookAgain)),
      database_(vitals_.Expect("database", kLookAgain)),
      looked_at_(std::chrono::steady_clock::now() - kLookAgain) {}

ServerHealth::Found ServerHealth::Look(storage::Store& store) {
  const std::lock_guard lock(mutex_);
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_at_ < kLookAgain) return {vitals_.States(now), disk_free_bytes_};
  looked_at_ = now;
  const auto room = storage::ProbeRoom(folder_);
  disk_free_bytes_ = room.value_or(0);
  room ? disk_.Rest() : disk_.Fail(room.error());
  const Status readable = CheckDatabase(store);
  readable ? database_.Rest() : database_.Fail(readable.error());
  return {vitals_.States(), disk_free_bytes_};
}

}  // namespace rigcal::pipeline
