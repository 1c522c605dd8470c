// When the messages of one topic came: how many, how often, the longest time without any, and how many were lost on the
// way. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace rigcal::recording {

// Times are nanoseconds of one steady clock.
class Arrivals {
 public:
  // One message of `bytes`. `sequence`: the publisher's number of it; 0: not known.
  void Add(std::int64_t now_ns, std::int64_t bytes, std::uint64_t publisher, std::int64_t sequence);
  // From here on RecentRate_hz counts anew.
  void BeginWindow(std::int64_t now_ns);

  // Of all that came.
  [[nodiscard]] std::int64_t messages() const { return messages_; }
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }
  // Sent and not come, by gaps in the publishers' numbers; what a publisher sent before the first and after the last
  // that came is not known.
  [[nodiscard]] std::int64_t missed() const { return missed_; }
  [[nodiscard]] std::optional<double> Rate_hz() const;                           // of all, from two messages on
  [[nodiscard]] std::optional<double> RecentRate_hz(std::int64_t now_ns) const;  // since BeginWindow, if it was called
  [[nodiscard]] std::int64_t LongestGap_ns() const { return longest_gap_ns_; }   // between two that came
  [[nodiscard]] std::optional<std::int64_t> SinceLast_ns(std::int64_t now_ns) const;
  // Nothing has come for long, by what it did before: two seconds, and five times as long as usual.
  [[nodiscard]] bool IsStalled(std::int64_t now_ns) const;

 private:
  std::int64_t messages_ = 0, bytes_ = 0, missed_ = 0;
  std::int64_t first_ns_ = 0, last_ns_ = 0, longest_gap_ns_ = 0;
  struct Window {
    std::optional<std::int64_t> start_ns = {};
    std::int64_t messages = 0;
  } window_;
  std::map<std::uint64_t, std::int64_t> last_sequences_;  // by publisher
};

}  // namespace rigcal::recording
