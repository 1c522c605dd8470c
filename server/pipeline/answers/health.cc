#include "server/pipeline/answers/health.h"

#include "storage/files/room.h"

namespace rigcal::pipeline {
namespace {

constexpr std::chrono::seconds kLookAgain{1};

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
  const Status readable = store.Read([]() -> Status { return {}; });
  readable ? database_.Rest() : database_.Fail(readable.error());
  return {vitals_.States(), disk_free_bytes_};
}

}  // namespace rigcal::pipeline
