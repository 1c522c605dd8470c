#include "client/text/progress.h"

#include <algorithm>
#include <cmath>

#include "client/text/table.h"

namespace rigcal::client {
namespace {
constexpr std::int64_t kRedraw_ns = 100'000'000;
constexpr std::int64_t kLineEvery_ns = 5'000'000'000;
constexpr int kBarWidth = 24;
constexpr double kRateAfter_s = 0.2;

bool ComesSlowly(Progress::Unit unit) { return unit == Progress::Unit::kPairs || unit == Progress::Unit::kSessions; }

// Before the first line. A file gets one soon enough, but of what comes slowly it says at once how much there is.
std::int64_t SilentFor_ns(bool is_terminal, Progress::Unit unit) {
  if (is_terminal) return kRedraw_ns;
  return ComesSlowly(unit) ? kLineEvery_ns : 0;
}

std::string Bar(double ratio) {
  const int filled = static_cast<int>(std::lround(std::clamp(ratio, 0.0, 1.0) * kBarWidth));
  return "[" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(kBarWidth - filled), '.') + "]";
}
}  // namespace

Progress::Progress(std::ostream& err, bool is_terminal, std::string label, std::int64_t now_ns, Unit unit)
    : err_(err),
      is_terminal_(is_terminal),
      label_(std::move(label)),
      start_ns_(now_ns),
      drawn_ns_(now_ns - SilentFor_ns(is_terminal, unit)),
      unit_(unit) {}

std::string Progress::Amount(double amount) const {
  switch (unit_) {
    case Unit::kBytes:
      break;
    case Unit::kEdges:
      return Fixed(amount, 0) + " edges";
    case Unit::kFiles:
      return Fixed(amount, 0) + " files";
    case Unit::kPairs:
      return Fixed(amount, 0) + " pairs";
    case Unit::kRows:
      return Fixed(amount, 0) + " rows";
    case Unit::kSessions:
      return Fixed(amount, 0) + " sessions";
  }
  return ByteText(amount);
}

std::string Progress::StandOf(double done, double total) const {
  const double ratio = total > 0 ? done / total : 0.0;
  const std::string bar = is_terminal_ ? Bar(ratio) : "";
  if (ComesSlowly(unit_)) return Fixed(done, 0) + " of " + Amount(total) + (bar.empty() ? "" : " " + bar);
  return bar + (bar.empty() ? "" : " ") + Fixed(100.0 * ratio, 0) + " %  " + Amount(done) + " of " + Amount(total);
}

std::string Progress::LineOf(const ProgressState& state, std::int64_t now_ns) const {
  const auto done = static_cast<double>(state.done), total = static_cast<double>(state.total);
  const double elapsed_s = static_cast<double>(now_ns - start_ns_) * 1e-9;
  const double rate = elapsed_s > kRateAfter_s ? (done - static_cast<double>(skipped_)) / elapsed_s : 0.0;
  std::string line = label_ + " " + StandOf(done, total);
  if (!state.detail.empty()) line += (unit_ == Unit::kSessions ? ", " : "  ") + state.detail;
  if (rate <= 0.0) return line;
  if (!ComesSlowly(unit_)) line += "  " + Amount(rate) + "/s";
  if (done < total) line += "  " + DurationText((total - done) / rate) + " left";
  return line;
}

bool Progress::IsDue(std::int64_t now_ns) const {
  return now_ns - drawn_ns_ >= (is_terminal_ ? kRedraw_ns : kLineEvery_ns);
}

void Progress::Show(const ProgressState& state, std::int64_t now_ns) {
  if (!IsDue(now_ns)) return;
  drawn_ns_ = now_ns;
  if (is_terminal_) {
    err_ << "\r\x1b[K" << LineOf(state, now_ns) << std::flush;
    bar_is_shown_ = true;
  } else {
    err_ << LineOf(state, now_ns) << std::endl;
  }
}

void Progress::Say(const std::string& line) {
  Clear();
  err_ << Plain(line) << std::endl;
}

void Progress::Clear() {
  if (bar_is_shown_) err_ << "\r\x1b[K" << std::flush;
  bar_is_shown_ = false;
}

std::string DurationText(double seconds) {
  if (!std::isfinite(seconds) || seconds > 360'000.0) return "> 100 h";
  const auto total_s = static_cast<std::int64_t>(std::ceil(std::max(seconds, 0.0)));
  if (total_s < 60) return std::to_string(total_s) + " s";
  const auto two = [](std::int64_t n) { return (n < 10 ? "0" : "") + std::to_string(n); };
  if (total_s < 3600) return std::to_string(total_s / 60) + " min " + two(total_s % 60) + " s";
  return std::to_string(total_s / 3600) + " h " + two(total_s / 60 % 60) + " min";
}

}  // namespace rigcal::client
