// The pause of a thread after a failure of DDS, before it tries again.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace rigcal::dds {

class Retry {
 public:
  // After a failure: a tenth of a second, so that nothing spins and what waits is taken soon; ends at Stop.
  void Pause() {
    std::unique_lock lock(mutex_);
    ended_.wait_for(lock, std::chrono::milliseconds(100), [&] { return stopped_; });
  }
  void Stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    ended_.notify_all();
  }
  [[nodiscard]] bool Stopped() const {
    const std::lock_guard lock(mutex_);
    return stopped_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable ended_;
  bool stopped_ = false;
};

}  // namespace rigcal::dds
