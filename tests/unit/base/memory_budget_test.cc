#include "server/base/process/memory_budget.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <atomic>
#include <chrono>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "server/base/process/out_of_memory.h"
#include "server/base/process/parallel_for.h"

namespace rigcal {
namespace {

TEST(MemoryBudget, NeverHoldsMoreThanItsLimit) {
  const std::int64_t bytes_max = 100;
  MemoryBudget budget([&] { return bytes_max; });
  std::atomic<std::int64_t> taken = 0, most = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 500; ++i) {
        const std::int64_t bytes = 10 + 13 * ((t + i) % 7);
        const auto share = budget.Take(bytes);
        const std::int64_t now = taken += bytes;
        for (std::int64_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) continue;
        taken -= bytes;
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(most, bytes_max);
}

TEST(MemoryBudget, SharesThatFitGoSideBySide) {
  const std::int64_t bytes_max = 100;
  MemoryBudget budget([&] { return bytes_max; });
  const auto share = budget.Take(60);
  std::thread([&] { EXPECT_TRUE(budget.Take(40)); }).join();
}

TEST(MemoryBudget, WhatNeverFitsIsRefusedAtOnce) {
  std::int64_t bytes_max = 100;
  MemoryBudget budget([&] { return bytes_max; });
  const auto all = budget.Take(100);
  ASSERT_TRUE(all);
  EXPECT_FALSE(budget.Take(101));
  bytes_max = 201;
  EXPECT_TRUE(budget.Take(101));
}

// Small shares that keep coming do not hold up a large one for ever: who came first is served first.
TEST(MemoryBudget, ALargeShareIsServedInTurn) {
  const std::int64_t bytes_max = 100;
  MemoryBudget budget([&] { return bytes_max; });
  std::atomic<bool> served = false;
  std::atomic<int> small = 0;
  std::optional<MemoryBudget::Share> first = budget.Take(60);
  std::thread large([&] {
    const auto share = budget.Take(100);
    served = true;
  });
  std::thread beside([&] {
    while (!served) {
      const auto share = budget.Take(10);
      ++small;
    }
  });
  first.reset();
  large.join();
  beside.join();
  EXPECT_TRUE(served);
}

// Otherwise a thread that waits for a loop within its work takes up other work of the loop around it, and waits there
// for the share that it holds itself.
TEST(RunApart, ALoopWithinWorkTakesUpNoOtherWork) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 8);  // it takes three, here or not
  static thread_local bool at_work = false;
  std::atomic<int> within = 0, done = 0;
  const auto part = [&](std::size_t) {
    const auto ends = std::chrono::steady_clock::now() + std::chrono::microseconds(20);
    while (std::chrono::steady_clock::now() < ends) continue;
    ++done;
  };
  const auto work = [&](std::size_t) {
    within += at_work ? 1 : 0;
    at_work = true;
    RunApart([&] { ParallelFor(8, part); });
    at_work = false;
  };
  ParallelFor(1024, work, 8);
  EXPECT_EQ(within, 0);
  EXPECT_EQ(done, 1024 * 8);
}

TEST(MemoryOfProcess, IsTheLeastOfItsLimits) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_DATA, &before), 0);
  EXPECT_GT(MemoryOfProcess(), 64 << 20);
  rlimit lower = before;
  lower.rlim_cur = 3u << 29;
  ASSERT_EQ(setrlimit(RLIMIT_DATA, &lower), 0);
  EXPECT_LE(MemoryOfProcess(), 3u << 29);
  ASSERT_EQ(setrlimit(RLIMIT_DATA, &before), 0);
}

TEST(OutOfMemory, IsToldFromOtherFailures) {
  EXPECT_TRUE(IsOutOfMemory(std::bad_alloc()));
  EXPECT_TRUE(IsOutOfMemory(std::bad_array_new_length()));
  EXPECT_TRUE(IsOutOfMemory(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again))));
  EXPECT_TRUE(IsOutOfMemory(std::runtime_error("OpenCV(4.6.0) error: (-4:Insufficient memory) Failed to allocate")));
  EXPECT_FALSE(IsOutOfMemory(std::system_error(std::make_error_code(std::errc::no_space_on_device))));
  EXPECT_FALSE(IsOutOfMemory(std::runtime_error("assertion failed")));
}

}  // namespace
}  // namespace rigcal
