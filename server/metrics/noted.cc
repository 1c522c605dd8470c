#include "server/metrics/noted.h"

#include <memory>

#include "server/base/process/guarded.h"
#include "server/metrics/families.h"

namespace rigcal::metrics {
namespace {

using Elsewhere = std::function<void(const StageRun&)>;

Elsewhere& NotedElsewhere() {
  static Elsewhere& elsewhere = *std::make_unique<Elsewhere>().release();
  return elsewhere;
}

void Count(prometheus::Family<prometheus::Counter>& family, const prometheus::Labels& labels) {
  family.Add(labels).Increment();
}

}  // namespace

std::string NameOf(Stage stage) {
  switch (stage) {
    case Stage::kReceive:
      return "receive";
    case Stage::kDetect:
      return "detect";
    case Stage::kCalibrate:
      return "calibrate";
    case Stage::kSolve:
      return "solve";
    case Stage::kReport:
      return "report";
  }
  return "receive";
}

std::optional<Stage> StageOf(const std::string& name) {
  for (const Stage stage : kStages)
    if (NameOf(stage) == name) return stage;
  return std::nullopt;
}

void Note(const StageRun& run) {
  if (NotedElsewhere()) return NotedElsewhere()(run);
  TheFamilies().stage_duration.at(run.stage)->Observe(run.took_s);
  if (run.failed) Count(TheFamilies().stage_failures, {{"stage", NameOf(run.stage)}});
}

void NoteElsewhere(Elsewhere told) { NotedElsewhere() = std::move(told); }

TimedStage::~TimedStage() {
  if (!counts_) return;
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  OnceThereIsMemory([&] { Note({stage_, took_s, failed_}); });
}

void NoteAnswer(Channel channel, double took_s) { TheFamilies().answer_duration.at(channel)->Observe(took_s); }

void NoteAnswerFailure(Channel channel, ErrorCode kind) {
  Count(TheFamilies().answer_failures, {{"channel", NameOf(channel)}, {"kind", rigcal::NameOf(kind)}});
}

void NoteReceipt(const std::string& state) { Count(TheFamilies().receipts, {{"state", state}}); }
void NoteRefusal(ErrorCode kind) { Count(TheFamilies().refusals, {{"kind", rigcal::NameOf(kind)}}); }
void NoteReceived(std::int64_t bytes) { TheFamilies().received_bytes.Increment(static_cast<double>(bytes)); }
void NotePushedEdges(std::size_t edges) { TheFamilies().edges_pushed.Increment(static_cast<double>(edges)); }
void NoteCalibratedEdge(bool is_good) {
  Count(TheFamilies().edges_calibrated, {{"state", is_good ? "good" : "failed"}});
}
void NoteRevision(const std::string& verdict) { Count(TheFamilies().revisions, {{"verdict", verdict}}); }
void NoteError(ErrorCode kind) { Count(TheFamilies().errors, {{"kind", rigcal::NameOf(kind)}}); }

}  // namespace rigcal::metrics
