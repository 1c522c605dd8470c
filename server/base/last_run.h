// How the process that served from a folder before this one ended: by its own doing, or by somebody else's.
#pragma once

#include <filesystem>

namespace rigcal {

enum class RunEnd {
  kMayBeItsOwn,  // it crashed, the system killed something for want of memory meanwhile, or nothing is known
  kFromOutside,  // killed while the system had memory (`kill -9`), or with the whole machine (power loss)
};

// Judges the last run by what it left in `folder`, notes this one, and from here on notes a crash (SIGABRT, SIGBUS, SIGFPE,
// SIGILL, SIGSEGV) before it takes its course. Where /proc does not tell, every end may be its own.
[[nodiscard]] RunEnd BeginRun(const std::filesystem::path& folder);

}  // namespace rigcal
