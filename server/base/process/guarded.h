// What a library throws, for want of memory above all, costs the piece of work that was under way, and no thread.
#pragma once

#include <exception>
#include <functional>
#include <new>

#include "server/base/process/vitals.h"
#include "server/base/result.h"

namespace rigcal {

// What a library threw, as an error of ours (kInternal). Waits until there is memory for the sentence: of what was
// under way nothing is held any more by then.
[[nodiscard]] Error BrokenOff(const std::exception& exception) noexcept;
// From here on an allocation of C++ that fails is tried again for a fifth of a second before it throws, and for as long
// as it takes where an exception is under way. Before any other thread is made.
void WaitForMemory();
// Returns after a hundredth of a second: by then others may have given memory back.
void AwaitMemory() noexcept;

// One piece of work: what it returns, a Result or Status, or what it threw.
template <typename Work>
auto Guarded(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& exception) {
    return Fail(BrokenOff(exception));
  }
}

// Something small that has to be done, and that may be begun again: for want of memory it is, until it is done.
template <typename Work>
auto OnceThereIsMemory(const Work& work) -> decltype(work()) {
  while (true) {
    try {
      return work();
    } catch (const std::bad_alloc&) {
      AwaitMemory();
    }
  }
}

// The life of a thread: `round` again and again, until it returns false. What it throws is the failure of `part`, or
// of nobody but the log; the next round comes a tenth of a second later.
void GoRound(Part* part, const std::function<bool()>& round);

}  // namespace rigcal
