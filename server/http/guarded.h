// What others hand in to be called from civetweb's threads may throw, and C code must not be unwound.
#pragma once

#include <exception>
#include <string>
#include <utility>

#include "server/base/log.h"
#include "server/base/process/guarded.h"
#include "server/base/result.h"

namespace rigcal::http {

// What `work` returns, a Result or Status; kInternal, with the reason in the log, where it throws. `what` names it:
// "/readyz", "a login".
template <typename Work>
auto Guarded(const std::string& what, Work&& work) -> decltype(work()) {
  Error thrown{ErrorCode::kInternal, "unknown exception", ""};
  try {
    return std::forward<Work>(work)();
  } catch (const std::exception& error) {
    thrown = BrokenOff(error);
  } catch (...) {  // said below
  }
  return OnceThereIsMemory([&]() -> decltype(work()) {
    LogError({thrown.code, what + ": " + thrown.what, thrown.cure});
    return Fail(ErrorCode::kInternal, "the server failed to answer " + what, "See the server's log.");
  });
}

}  // namespace rigcal::http
