// The processes that work for this server (worker.h): started when they are needed, kept warm, ended when they have
// grown.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/pipeline/workers/worker_process.h"

namespace rigcal::pipeline {

class WorkerPool {
 public:
  struct Options {
    std::vector<std::string> command;  // arguments, the name that it goes by first
    std::string program = "/proc/self/exe";
    std::chrono::seconds order_max{6 * 3600};
  };
  // Starts nothing yet.
  explicit WorkerPool(Options options);
  ~WorkerPool();  // those that are idle end; nobody is in Run any more
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  using Outcome = WorkerOutcome;
  // Carries out an order in a process that has no other, and gives what it says. An error of the order is its own;
  // where the process ended amid the order, or took longer than `order_max`, `died` is true and the error says how. Any
  // thread.
  [[nodiscard]] Outcome Run(const std::string& order);
  // Starts one, so that the first order need not wait for it.
  void Warm();

 private:
  [[nodiscard]] std::unique_ptr<WorkerProcess> TakeWarmest();

  Options options_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<WorkerProcess>> idle_;  // the one that worked last is last
};

}  // namespace rigcal::pipeline
