// What a recording sees of its topics, for people and as JSON.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "client/record/recorder.h"

namespace rigcal::recording {

struct RecordingOutcome {
  std::filesystem::path bag;
  std::int64_t elapsed_ns = 0;
  std::vector<TopicSeen> topics;
  BagTotals totals;
  bool ended_early = false;  // the disk ended it
  // Every sensor has messages, and nothing is missing that was sent.
  [[nodiscard]] bool IsWhole() const;
};

// "recorded", "nobody_publishes", "other_type", "silent", "stalled", "ended".
[[nodiscard]] const char* NameOf(TopicState state);
// A table with a line for each topic.
void PrintTopics(const std::vector<TopicSeen>& topics, std::ostream& out);
// The same, and below it what is missing.
void PrintRecording(const RecordingOutcome& outcome, std::ostream& out);
// One line: {"kind": "progress", ...}, {"kind": "recorded", ...} as docs/record.md has them.
[[nodiscard]] std::string ProgressJson(std::int64_t elapsed_ns, const std::vector<TopicSeen>& topics);
[[nodiscard]] std::string RecordingJson(const RecordingOutcome& outcome);

// A table that redraws itself on a terminal. Times are nanoseconds of a steady clock.
class LiveTable {
 public:
  // Draws on `err`, a terminal.
  explicit LiveTable(std::ostream& err) : err_(err) {}
  ~LiveTable() { Clear(); }
  LiveTable(const LiveTable&) = delete;
  LiveTable& operator=(const LiveTable&) = delete;
  // In place of what is shown.
  void Show(const std::string& text);
  // A sentence that stays, above it.
  void Say(const std::string& sentence);
  // Takes it away.
  void Clear();

 private:
  std::ostream& err_;
  std::size_t lines_ = 0;
};

}  // namespace rigcal::recording
