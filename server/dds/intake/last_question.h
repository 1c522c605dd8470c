// When somebody last asked: what is taken in yields to who waits for an answer.
#pragma once

#include <atomic>
#include <chrono>

namespace rigcal::dds {

// Any thread.
class LastQuestion {
 public:
  // Now somebody asked.
  void Note() { at_ = Clock::now().time_since_epoch(); }
  // Whether that was at most `span` ago; not at first.
  [[nodiscard]] bool IsWithin(std::chrono::milliseconds span) const {
    return Clock::now().time_since_epoch() - at_.load() < span;
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::atomic<Clock::duration> at_ = -std::chrono::duration_cast<Clock::duration>(std::chrono::hours(1));
};

}  // namespace rigcal::dds
