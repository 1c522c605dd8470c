// The processes that work for this server (worker.h), as the server has them: started when they are needed, kept warm,
// ended when they have grown.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/base/process/memory_budget.h"
#include "server/base/result.h"

namespace rigcal::pipeline {

// The memory that a process is given to decode in, of the server's budget. It asks one after the other: who asks for
// another waits in any case. What is still asked for when the process has ended is taken and given back at once, in its
// turn; nobody waits for that. Any thread. Held by a shared pointer: who waits for memory may outlive the process that
// asked.
class MemoryOnBehalf : public std::enable_shared_from_this<MemoryOnBehalf> {
 public:
  // Called from another thread, and not after End.
  using Granted = std::function<void(const std::string& id)>;
  // `granted` is told each id whose bytes are set aside.
  explicit MemoryOnBehalf(Granted granted) : granted_(std::move(granted)) {}

  // Throws std::system_error where no thread can be made.
  void Ask(const std::string& id, std::int64_t bytes);
  void Give(const std::string& id);
  void End();  // gives all back

 private:
  void TakeAll();
  [[nodiscard]] bool TakeFirst();  // false: nothing is asked for

  std::mutex mutex_;
  const Granted granted_;
  std::deque<std::pair<std::string, std::int64_t>> asked_;
  std::map<std::string, MemoryBudget::Share> shares_;
  bool asking_ = false, ended_ = false;
};

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

// One process that carries out orders: its pipes, the memory it was given, and how it ended. One thread at a time.
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
