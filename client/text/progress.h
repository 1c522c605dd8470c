// Progress for people, on standard error: a bar that redraws itself on a terminal, else a line every few seconds.
#pragma once

#include <cstdint>
#include <optional>
#include <ostream>
#include <string>

namespace rigcal::client {

struct ProgressState {
  std::int64_t done = 0, total = 0;  // in the unit of the bar
  std::string detail;                // "12/40 captures"
};

class Progress {
 public:
  // Pairs and sessions come slowly: "Calibrating 6 of 59 pairs", without a rate.
  enum class Unit { kBytes, kEdges, kFiles, kPairs, kRows, kSessions };
  // Times are nanoseconds of a steady clock.
  Progress(std::ostream& err, bool is_terminal, std::string label, std::int64_t now_ns, Unit unit = Unit::kBytes);
  [[nodiscard]] bool IsDue(std::int64_t now_ns) const;
  // Draws if something is due; cheap to call often.
  void Show(const ProgressState& state, std::int64_t now_ns);
  // What was there before the work began does not count towards the rate.
  void Skip(std::int64_t done_before) { skipped_ = done_before; }
  // A whole line of its own, above the bar.
  void Say(const std::string& line);
  // Removes the bar.
  void Clear();

 private:
  [[nodiscard]] std::string Amount(double amount) const;
  [[nodiscard]] std::string StandOf(double done, double total) const;
  [[nodiscard]] std::string LineOf(const ProgressState& state, std::int64_t now_ns) const;

  std::ostream& err_;
  bool is_terminal_;
  std::string label_;
  std::int64_t start_ns_, drawn_ns_;
  Unit unit_;
  std::int64_t skipped_ = 0;
  bool bar_is_shown_ = false;
};

// Seconds as "1 h 02 min", "3 min 20 s", "12 s".
[[nodiscard]] std::string DurationText(double seconds);

}  // namespace rigcal::client
