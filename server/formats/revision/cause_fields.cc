#include "server/formats/revision/cause_fields.h"

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kSentenceMax = 64u << 10;  // it may name many boards

template <typename AnId>
void WriteNamed(JsonWriter& out, std::string_view key, const std::vector<AnId>& ids) {
  out.List(key, [&] {
    for (const AnId& id : ids) out.Text(id.str());
  });
}

template <typename AnId>
std::vector<AnId> ReadNamed(const JsonField& field, std::size_t count_max) {
  std::vector<AnId> ids;
  for (const JsonField& id : field.Items(count_max)) ids.push_back(ReadId<AnId>(id));
  return ids;
}

void WriteCause(JsonWriter& out, const Cause& cause) {
  out.Object([&] {
    out.Text("kind", cause.kind);
    out.Text("key", cause.key);
    WriteNamed(out, "sensors", cause.sensors);
    WriteNamed(out, "boards", cause.boards);
    WriteNamed(out, "captures", cause.captures);
    WriteNamed(out, "edges", cause.edges);
    out.Text("why", cause.why);
    out.Text("what_to_do", cause.what_to_do);
    cause.command.empty() ? out.Null("command") : out.Text("command", cause.command);
  });
}

Cause ReadCause(const JsonField& field) {
  Cause cause;
  cause.kind = field.At("kind").Text();
  cause.key = field.At("key").Text();
  cause.sensors = ReadNamed<SensorId>(field.At("sensors"), limits::kSensorsPerRobotMax);
  cause.boards = ReadNamed<TargetId>(field.At("boards"), limits::kEdgesPerBatchMax);
  cause.captures = ReadNamed<CaptureId>(field.At("captures"), limits::kEdgesPerBatchMax);
  cause.edges = ReadNamed<EdgeId>(field.At("edges"), limits::kEdgesPerBatchMax);
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
