// The memory that a process is given to decode in, of the server's budget. It asks one after the other: who asks for
// another waits in any case. What is still asked for when the process has ended is taken and given back at once, in its
// turn; nobody waits for that.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/base/process/memory_budget.h"

namespace rigcal::pipeline {

// Any thread. Held by a shared pointer: who waits for memory may outlive the process that asked.
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

}  // namespace rigcal::pipeline
