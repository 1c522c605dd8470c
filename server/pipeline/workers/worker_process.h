// One process that carries out orders (worker.h), as the server has it: its pipes, the memory it was given, and how it
// ended.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/result.h"
#include "server/pipeline/workers/memory_on_behalf.h"

namespace rigcal::pipeline {

// Closed when it goes.
class PipeEnd {
 public:
  PipeEnd() = default;
  // Takes `fd` over.
  explicit PipeEnd(int fd) : fd_(fd) {}
  ~PipeEnd();
  // The other end gives what it has, and may be destroyed.
  PipeEnd(PipeEnd&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  PipeEnd& operator=(PipeEnd&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  [[nodiscard]] int get() const { return fd_; }  // negative: none

 private:
  int fd_ = -1;
};

// What became of an order.
struct WorkerOutcome {
  Result<std::string> said;
  bool died = false;  // the process ended amid the order
};

// One thread at a time.
class WorkerProcess {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // `arguments`: the name that it goes by first. kStorage where the system gives no process.
  [[nodiscard]] static Result<std::unique_ptr<WorkerProcess>> Start(const std::string& program,
                                                                    const std::vector<std::string>& arguments);
  ~WorkerProcess();  // ends it: by its input, or at once where it is amid an order
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  // False: it had ended before.
  [[nodiscard]] bool Tell(const std::string& order);
  // Until it has said how that went, or that time.
  [[nodiscard]] WorkerOutcome Await(Time until);
  // Not where it failed to say so, has carried out very many orders, or holds more than `bytes_max` after one.
  [[nodiscard]] bool IsWorthKeeping(std::int64_t bytes_max) const;

 private:
  WorkerProcess(pid_t pid, PipeEnd orders, PipeEnd answers);
  void Say(const std::string& text);
  [[nodiscard]] std::optional<std::string> NextLine(Time until);  // nothing when its answers end, or at that time
  [[nodiscard]] std::string End(Time until);                      // how it ended, in words

  pid_t pid_;
  PipeEnd orders_, answers_;
  std::string read_;
  bool broken_ = false;  // amid an order
  int told_ = 0;
  std::mutex saying_;
  std::shared_ptr<MemoryOnBehalf> memory_;
};

}  // namespace rigcal::pipeline
