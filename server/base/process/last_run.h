// How the process that worked on a folder before this one ended: by its own doing, or by somebody else's.
#pragma once

#include <filesystem>

namespace rigcal {

enum class RunEnd {
  kMayBeItsOwn,  // it crashed, the system killed something for want of memory meanwhile, or nothing is known
  kFromOutside,  // killed while the system had memory (`kill -9`), or with the whole machine (power loss)
};

// By what it left in `folder`. Where /proc does not tell, every end may be its own. So may some that look as if they
// came from outside: an overflow of the stack, or a killer for want of memory that is not the kernel's.
[[nodiscard]] RunEnd EndOfLastRun(const std::filesystem::path& folder);
// Forgets it, notes this run, and from here on notes a crash (SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS,
// SIGTRAP) before it takes its course. A run that cannot be noted (a full disk) may have ended by its own doing.
void BeginRun(const std::filesystem::path& folder);

}  // namespace rigcal
