// The address of the reports that robots and people are told: known once the server has its port, and changed by who
// changes --public-url.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <utility>

namespace rigcal {

// Any thread.
class ToldAddress {
 public:
  void Set(std::string address) {
    {
      const std::lock_guard lock(mutex_);
      address_ = std::move(address);
    }
    known_.notify_all();
  }
  // Waits for the first Set.
  [[nodiscard]] std::string Get() {
    std::unique_lock lock(mutex_);
    known_.wait(lock, [this] { return !address_.empty(); });
    return address_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable known_;
  std::string address_;
};

}  // namespace rigcal
