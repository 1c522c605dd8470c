#include "server/base/process/thread_rank.h"

#include <linux/sched/types.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace rigcal {
namespace {

// A nice value alone leaves a thread that wakes up waiting for the end of the slice that runs. Newer kernels end it
// early where the running thread asked for longer slices than the waking one; older ones ignore the wish.
// <sched.h> cannot stand beside the header above.
constexpr __u32 kUsual = 0, kRoundRobin = 2;

struct Wish {
  __u32 priority;  // in real time; 0: the usual policy
  int nice;
  __u64 slice_ns;
};

Wish WishOf(ThreadRank rank) {
  switch (rank) {
    case ThreadRank::kAnswers:
      return {2, 0, 1'000'000};  // longer than an answer takes: it must not be cut in two
    case ThreadRank::kTakes:
      return {1, 0, 2'000'000};
    case ThreadRank::kServes:
      return {0, 0, 2'000'000};
    case ThreadRank::kStores:
      return {0, 5, 5'000'000};
    case ThreadRank::kWorks:
      return {0, 10, 20'000'000};
  }
  return {0, 0, 2'000'000};
}

}  // namespace

void SetThreadRank(ThreadRank rank) {
  const Wish wish = WishOf(rank);
  sched_attr wanted{};
  wanted.size = sizeof wanted;
  if (wish.priority > 0) {
    wanted.sched_policy = kRoundRobin;
    wanted.sched_priority = wish.priority;
    if (::syscall(SYS_sched_setattr, 0, &wanted, 0) == 0) return;
  }
  wanted.sched_policy = kUsual;
  wanted.sched_priority = 0;
  wanted.sched_nice = wish.nice;
  wanted.sched_runtime = wish.slice_ns;
  static_cast<void>(::syscall(SYS_sched_setattr, 0, &wanted, 0));  // 0: the calling thread
}

}  // namespace rigcal
