#include "server/http/connections/worker_stack.h"

#include <dlfcn.h>
#include <pthread.h>

#include <algorithm>

// Found by libcivetweb before the C library's own, as a symbol of the executable.
extern "C" int pthread_attr_setstacksize(pthread_attr_t* attributes, std::size_t size_bytes) noexcept {
  using SetStackSize = int (*)(pthread_attr_t*, std::size_t);
  static const auto next = reinterpret_cast<SetStackSize>(dlsym(RTLD_NEXT, "pthread_attr_setstacksize"));
  return next(attributes, std::max(size_bytes, rigcal::http::kWorkerStack_bytes));
}

namespace rigcal::http {
void RaiseWorkerStacks() {}
}  // namespace rigcal::http
