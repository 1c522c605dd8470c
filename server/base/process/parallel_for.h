// Parallel loop on oneTBB. Body(i) must write only to its own slot: then the result does not depend on threads.
#pragma once

#include <cstddef>
#include <functional>

namespace rigcal {

// Calls body(0..count-1), in any order, on as many threads as the machine has, or at most `threads_max` if that is not
// 0. Exceptions of a body propagate; a loop within a body is whole or throws, whatever other parts of the outer throw.
void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body, int threads_max = 0);

// Runs `work`; while a loop within it (a library's too) waits for its parts, the thread takes up no other part of a
// loop around it. For work that holds what the other parts wait for.
void RunApart(const std::function<void()>& work);

}  // namespace rigcal
