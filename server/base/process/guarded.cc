#include "server/base/process/guarded.h"

#include <chrono>
#include <thread>

#include "server/base/log.h"
#include "server/base/process/out_of_memory.h"

namespace rigcal {
namespace {

Error SaidOf(const std::exception& exception) {
  if (IsOutOfMemory(exception))
    return {ErrorCode::kInternal, std::string("the server had no memory left (") + exception.what() + ")",
            "Give the server more memory, or push fewer and smaller pictures and clouds."};
  return {ErrorCode::kInternal, std::string("the work broke off: ") + exception.what(),
          "Report this with the log of the server."};
}

}  // namespace

namespace {

// While a stack is unwound nothing may be thrown, and destructors of libraries allocate, too (nlohmann-json's).
void WaitOrThrow() {
  constexpr int kTries = 20;
  thread_local int tries = 0;
  if (std::uncaught_exceptions() == 0 && ++tries % kTries == 0) throw std::bad_alloc();
  AwaitMemory();
}

}  // namespace

void WaitForMemory() { std::set_new_handler(WaitOrThrow); }

void AwaitMemory() noexcept { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }

Error BrokenOff(const std::exception& exception) noexcept {
  return OnceThereIsMemory([&] { return SaidOf(exception); });
}

void GoRound(Part* part, const std::function<bool()>& round) {
  constexpr std::chrono::milliseconds kPause{100};
  for (bool more = true; more;) {
    auto went = Guarded([&]() -> Result<bool> { return round(); });
    more = !went || *went;
    if (went) continue;
    if (part != nullptr)
      part->Fail(std::move(went).error());
    else
      LogError(went.error());
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace rigcal
