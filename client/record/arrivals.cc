#include "client/record/arrivals.h"

#include <algorithm>

namespace rigcal::recording {
namespace {

constexpr double kNsPerS = 1e9;
constexpr std::int64_t kStallAtLeast_ns = 2'000'000'000;
constexpr double kStallPeriods = 5.0;
constexpr std::int64_t kOftenFrom = 5;  // messages from which on it is known how often they come

}  // namespace

void Arrivals::Add(std::int64_t now_ns, std::int64_t bytes, std::uint64_t publisher, std::int64_t sequence) {
  if (messages_ == 0) first_ns_ = now_ns;
  if (messages_ > 0) longest_gap_ns_ = std::max(longest_gap_ns_, now_ns - last_ns_);
  last_ns_ = now_ns;
  ++messages_;
  ++window_.messages;
  bytes_ += bytes;
  if (sequence <= 0) return;
  const auto [last, is_first] = last_sequences_.emplace(publisher, sequence);
  if (is_first) return;
  missed_ += std::max<std::int64_t>(0, sequence - last->second - 1);
  last->second = std::max(last->second, sequence);
}

void Arrivals::BeginWindow(std::int64_t now_ns) {
  window_.start_ns = now_ns;
  window_.messages = 0;
}

std::optional<double> Arrivals::Rate_hz() const {
  if (messages_ < 2 || last_ns_ <= first_ns_) return std::nullopt;
  return static_cast<double>(messages_ - 1) * kNsPerS / static_cast<double>(last_ns_ - first_ns_);
}

std::optional<double> Arrivals::RecentRate_hz(std::int64_t now_ns) const {
  if (!window_.start_ns || now_ns <= *window_.start_ns) return std::nullopt;
  return static_cast<double>(window_.messages) * kNsPerS / static_cast<double>(now_ns - *window_.start_ns);
}

std::optional<std::int64_t> Arrivals::SinceLast_ns(std::int64_t now_ns) const {
  return messages_ == 0 ? std::nullopt : std::optional(now_ns - last_ns_);
}

bool Arrivals::IsStalled(std::int64_t now_ns) const {
  const auto rate_hz = Rate_hz();
  if (messages_ < kOftenFrom || !rate_hz) return false;
  const std::int64_t since_ns = now_ns - last_ns_;
  return since_ns > kStallAtLeast_ns && static_cast<double>(since_ns) > kStallPeriods * kNsPerS / *rate_hz;
}

}  // namespace rigcal::recording
