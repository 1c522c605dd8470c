#include "server/formats/revision/cause_fields.h"

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kSentenceMax = 64u << 10;  // it may name many boards

void WriteCause(JsonWriter& out, const Cause& cause) {
  out.Object([&] {
    out.Text("kind", cause.kind);
    out.Text("key", cause.key);
    WriteIds(out, "sensors", cause.sensors);
    WriteIds(out, "boards", cause.boards);
    WriteIds(out, "captures", cause.captures);
    WriteIds(out, "edges", cause.edges);
    out.Text("why", cause.why);
    out.Text("what_to_do", cause.what_to_do);
    cause.command.empty() ? out.Null("command") : out.Text("command", cause.command);
  });
}

Cause ReadCause(const JsonField& field) {
  Cause cause;
  cause.kind = field.At("kind").Text();
  cause.key = field.At("key").Text();
  cause.sensors = ReadIds<SensorId>(field.At("sensors"), limits::kSensorsPerRobotMax);
  cause.boards = ReadIds<TargetId>(field.At("boards"), limits::kEdgesPerBatchMax);
  cause.captures = ReadIds<CaptureId>(field.At("captures"), limits::kEdgesPerBatchMax);
  cause.edges = ReadIds<EdgeId>(field.At("edges"), limits::kEdgesPerBatchMax);
  cause.why = field.At("why").Text(kSentenceMax);
  cause.what_to_do = field.At("what_to_do").Text(kSentenceMax);
  if (const auto command = field.Find("command")) cause.command = command->Text();
  return cause;
}

}  // namespace

void WriteCauses(JsonWriter& out, const std::vector<Cause>& causes) {
  if (causes.empty()) return;
  out.List("causes", [&] {
    for (const Cause& cause : causes) WriteCause(out, cause);
  });
}

std::vector<Cause> ReadCauses(const JsonField& root) {
  std::vector<Cause> causes;
  const auto field = root.Find("causes");
  if (!field) return causes;
  for (const JsonField& cause : field->Items(limits::kEdgesPerBatchMax)) causes.push_back(ReadCause(cause));
  return causes;
}

}  // namespace rigcal::formats
