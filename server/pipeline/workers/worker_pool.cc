#include "server/pipeline/workers/worker_pool.h"

#include <algorithm>

#include "server/base/log.h"
#include "server/base/process/memory_budget.h"

namespace rigcal::pipeline {
namespace {

std::int64_t IdleBytesMax() { return std::min<std::int64_t>(512LL << 20, MemoryOfProcess() / 16); }

}  // namespace

WorkerPool::WorkerPool(Options options) : options_(std::move(options)) {}
WorkerPool::~WorkerPool() = default;

std::unique_ptr<WorkerProcess> WorkerPool::TakeWarmest() {
  const std::lock_guard lock(mutex_);
  if (idle_.empty()) return nullptr;
  std::unique_ptr<WorkerProcess> worker = std::move(idle_.back());
  idle_.pop_back();
  return worker;
}

void WorkerPool::Warm() {
  auto started = WorkerProcess::Start(options_.program, options_.command);
  if (!started) return LogError(started.error());
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(*started));
}

WorkerPool::Outcome WorkerPool::Run(const std::string& order) {
  std::unique_ptr<WorkerProcess> worker = TakeWarmest();
  while (worker != nullptr && !worker->Tell(order)) worker = TakeWarmest();  // it ended while it was idle
  if (worker == nullptr) {
    auto started = WorkerProcess::Start(options_.program, options_.command);
    if (!started) return {Fail(started.error())};
    worker = std::move(*started);
    if (!worker->Tell(order))
      return {Fail(ErrorCode::kStorage, "a process to work in ended at its start", "Look at the log of the server.")};
  }
  Outcome outcome{std::string()};
  try {
    outcome = worker->Await(std::chrono::steady_clock::now() + options_.order_max);
  } catch (const std::exception& thrown) {  // no thread, no memory
    return {Fail(ErrorCode::kInternal,
                 std::string("the server could not follow the process that did the work: ") + thrown.what(),
                 "Nothing, if it is done at the next attempt; else give the server more memory."),
            true};
  }
  if (!worker->IsWorthKeeping(IdleBytesMax())) return outcome;
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(worker));
  return outcome;
}

}  // namespace rigcal::pipeline
