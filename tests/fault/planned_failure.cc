#include "tests/fault/planned_failure.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>

#include "tests/fault/real_calls.h"

namespace rigcal::fault {
namespace {

// Shared with who plans; disk_record.py knows the same.
struct Plan {
  char kind[8];
  std::int64_t at;  // 0: none
  std::int64_t error;
  std::atomic<std::int64_t> count;
};

Plan* Map() {
  const char* name = std::getenv("RIGCAL_FAULT_PLAN");
  const int file = name == nullptr ? -1 : Real<int(const char*, int, ...)>("open")(name, O_RDWR | O_CLOEXEC);
  if (file < 0) return nullptr;
  void* mapped = mmap(nullptr, sizeof(Plan), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  return mapped == MAP_FAILED ? nullptr : static_cast<Plan*>(mapped);
}

// Null: none of that kind.
Plan* PlanOf(std::string_view kind) {
  static Plan* const plan = Map();
  return plan == nullptr || plan->at == 0 || kind != plan->kind ? nullptr : plan;
}

}  // namespace

bool FailsInRow(std::string_view kind) {
  Plan* const plan = PlanOf(kind);
  if (plan == nullptr) return false;
  const std::int64_t number = plan->count.fetch_add(1) + 1;
  return number >= plan->at && number < plan->at + plan->error;
}

bool FailsAsPlanned(std::string_view kind) {
  Plan* const plan = PlanOf(kind);
  if (plan == nullptr) return false;
  if (plan->count.fetch_add(1) + 1 != plan->at) return false;
  if (plan->error == 0) std::raise(SIGKILL);
  errno = static_cast<int>(plan->error);
  return true;
}

}  // namespace rigcal::fault
