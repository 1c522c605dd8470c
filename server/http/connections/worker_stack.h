// Stack size of civetweb's threads.
#pragma once

#include <cstddef>

namespace rigcal::http {

// civetweb asks for stacks of 100 KiB and has no option for it. Static thread-local storage comes out of the same
// stack, and the libraries of rigcald (glog, METIS) take 60 KiB of it: a reply overflows what is left. Every stack size
// that is asked for in this process is therefore raised to at least this.
constexpr std::size_t kWorkerStack_bytes = 1 << 20;
// Call before the first thread of civetweb: keeps the override linked in.
void RaiseWorkerStacks();

}  // namespace rigcal::http
