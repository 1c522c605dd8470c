// What happened in this process since it began, as counters and histograms of Prometheus: noted where it happens, read
// by exposition.h. Any thread; never blocks for longer than a few instructions.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "server/base/result.h"

namespace rigcal::metrics {

enum class Stage {
  kReceive,    // a session, from its first word to the last receipt
  kDetect,     // the boards of one sensor's pictures or clouds of a session that nobody searched before
  kCalibrate,  // one pair, from what is stored to its edge, with the detection that it needed
  kSolve,      // a robot's graph and, where it is due, its revision
  kReport,     // the pages of one revision
};
inline constexpr std::array kStages = {Stage::kReceive, Stage::kDetect, Stage::kCalibrate, Stage::kSolve,
                                       Stage::kReport};
[[nodiscard]] std::string NameOf(Stage stage);                        // "receive", ...
[[nodiscard]] std::optional<Stage> StageOf(const std::string& name);  // nothing: there is none of that name

struct StageRun {
  Stage stage = Stage::kReceive;
  double took_s = 0.0;
  bool failed = false;
};
// Counted at once, in this process. Any thread.
void Note(const StageRun& run);
// From now on Note hands runs to this instead: a process that works for another one tells that. Before any other thread
// is made.
void NoteElsewhere(std::function<void(const StageRun&)> told);

// Notes a run when it goes: of a failure, unless it was said to be done.
class TimedStage {
 public:
  // The run begins now.
  explicit TimedStage(Stage stage) : stage_(stage), began_(std::chrono::steady_clock::now()) {}
  ~TimedStage();
  TimedStage(const TimedStage&) = delete;
  TimedStage& operator=(const TimedStage&) = delete;
  // It did not fail.
  void Done() { failed_ = false; }
  void Leave() { counts_ = false; }  // it was none: there was nothing to do

 private:
  const Stage stage_;
  const std::chrono::steady_clock::time_point began_;
  bool failed_ = true, counts_ = true;
};

// A run of `body`, which gives a Result or a Status.
template <typename Body>
auto Timed(Stage stage, const Body& body) -> decltype(body()) {
  TimedStage timed(stage);
  auto result = body();
  if (result) timed.Done();
  return result;
}

enum class Channel { kDds, kHttp };
// One question: from when it was taken until its answer was made (HTTP), or was sent whole (DDS).
void NoteAnswer(Channel channel, double took_s);
void NoteAnswerFailure(Channel channel, ErrorCode kind);

// `state`: "closed", "need_manifest", "receiving", "refused".
void NoteReceipt(const std::string& state);
void NoteRefusal(ErrorCode kind);       // of what was pushed or ordered
void NoteReceived(std::int64_t bytes);  // of payloads that became durable
void NotePushedEdges(std::size_t edges);
void NoteCalibratedEdge(bool is_good);
void NoteRevision(const std::string& verdict);
void NoteError(ErrorCode kind);  // that was logged

}  // namespace rigcal::metrics
