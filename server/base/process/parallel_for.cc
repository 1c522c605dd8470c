#include "server/base/process/parallel_for.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace rigcal {

void ParallelFor(std::size_t count, const std::function<void(std::size_t)>& body, int threads_max) {
  const auto loop = [&] {
    // Bound to the loop around it, as by default, it would end early and say nothing once another part of that throws.
    tbb::task_group_context apart(tbb::task_group_context::isolated);
    tbb::parallel_for(
        std::size_t{0}, count, [&](std::size_t i) { body(i); }, apart);
  };
  if (threads_max <= 0) return loop();
  tbb::task_arena arena(threads_max);
  arena.execute(loop);
}

void RunApart(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

}  // namespace rigcal
