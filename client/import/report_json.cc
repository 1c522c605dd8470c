#include <cstdint>

#include "client/import/moments_json.h"
#include "client/import/report.h"
#include "server/formats/json/json_field.h"
#include "server/formats/json/json_values.h"
#include "server/formats/json/json_writer.h"

namespace rigcal::importing {
namespace {

using formats::JsonWriter;

void WriteDamage(JsonWriter& out, const std::vector<Error>& damage) {
  out.List("damage", [&] {
    for (const Error& error : damage) out.Object([&] { formats::WriteErrorMembers(out, error); });
  });
}

void WriteOffset(JsonWriter& out, const std::optional<OffsetSpread>& offset) {
  if (!offset) return out.Null("stamp_minus_log_ns");
  out.Object("stamp_minus_log_ns", [&] {
    out.Integer("min", offset->min_ns);
    out.Integer("median", offset->median_ns);
    out.Integer("max", offset->max_ns);
  });
}

void WriteTopic(JsonWriter& out, const TopicSurvey& topic) {
  out.Text("topic", topic.name);
  out.Text("type", topic.type);
  out.Text("encoding", topic.encoding);
  out.Integer("messages", topic.count);
  out.Integer("bytes", topic.bytes);
  if (topic.rate_hz)
    out.Number("rate_hz", *topic.rate_hz);
  else
    out.Null("rate_hz");
  out.Integer("first_log_ns", topic.first_ns);
  out.Integer("last_log_ns", topic.last_ns);
  out.Integer("longest_gap_ns", topic.longest_gap_ns);
  out.Integer("longest_gap_begins_ns", topic.gap_at_ns);
  WriteOffset(out, topic.stamp_offset);
  out.Integer("unset_stamps", topic.unset_stamps);
  out.Integer("backward_stamps", topic.backward_stamps);
  out.Text("frame", topic.frame);
  out.Text("detail", topic.detail);
  if (!topic.camera_change.empty()) out.Text("camera_change", topic.camera_change);
  out.Text("sensor", topic.sensor_kind);
  out.Text("trouble", topic.trouble);
}

void WriteSensor(JsonWriter& out, const SensorOutcome& sensor) {
  out.Text("id", sensor.id);
  out.Text("topic", sensor.topic);
  out.Integer("messages", sensor.messages);
  out.Integer("written", sensor.written);
  out.Integer("refused", sensor.refused);
  out.Text("first_refusal", sensor.first_refusal);
  out.Integer("without_partner", static_cast<std::int64_t>(sensor.use.without_partner));
  out.Integer("repeated_stamps", static_cast<std::int64_t>(sensor.use.repeated_stamp) + sensor.repeated_stamps);
  out.Integer("thinned_out", static_cast<std::int64_t>(sensor.use.thinned_out));
  out.Integer("left_out", static_cast<std::int64_t>(sensor.use.left_out));
  if (!sensor.camera_change.empty()) out.Text("camera_change", sensor.camera_change);
}

constexpr std::size_t kOutcomeBytesMax = 16 << 20, kOutcomeListMax = 100'000, kSentenceBytesMax = 64 << 10;

std::int64_t CountAt(const formats::JsonField& field, std::string_view key) {
  return field.At(key).Integer(0, INT64_MAX);
}

SensorOutcome SensorAt(const formats::JsonField& field) {
  SensorOutcome sensor;
  sensor.id = field.At("id").Text();
  sensor.topic = field.At("topic").Text(kSentenceBytesMax);
  sensor.messages = CountAt(field, "messages");
  sensor.written = CountAt(field, "written");
  sensor.refused = CountAt(field, "refused");
  sensor.first_refusal = field.At("first_refusal").Text(kSentenceBytesMax);
  sensor.use.without_partner = static_cast<std::size_t>(CountAt(field, "without_partner"));
  sensor.use.thinned_out = static_cast<std::size_t>(CountAt(field, "thinned_out"));
  if (const auto left_out = field.Find("left_out"))
    sensor.use.left_out = static_cast<std::size_t>(left_out->Integer(0, INT64_MAX));
  if (const auto change = field.Find("camera_change")) sensor.camera_change = change->Text(kSentenceBytesMax);
  sensor.repeated_stamps = CountAt(field, "repeated_stamps");  // of both kinds: they are told as one
  return sensor;
}

Error ErrorAt(const formats::JsonField& field) {
  return {ErrorCodeOf(field.At("code").Text()), field.At("what").Text(kSentenceBytesMax),
          field.At("cure").Text(kSentenceBytesMax)};
}

}  // namespace

std::string SurveyJson(const BagSurvey& survey) {
  return formats::WriteObject([&](JsonWriter& out) {
    out.Integer("messages", survey.messages);
    out.Integer("first_log_ns", survey.first_ns);
    out.Integer("last_log_ns", survey.last_ns);
    out.List("topics", [&] {
      for (const TopicSurvey& topic : survey.topics) out.Object([&] { WriteTopic(out, topic); });
    });
    WriteDamage(out, survey.damage);
  });
}

std::string OutcomeJson(const ImportOutcome& outcome, const std::string& folder) {
  return formats::WriteObject([&](JsonWriter& out) {
    out.Text("session", folder);
    out.Flag("was_complete", outcome.was_complete);
    out.Integer("captures", static_cast<std::int64_t>(outcome.captures));
    out.Integer("tolerance_ns", outcome.tolerance_ns);
    out.Integer("kept_files", outcome.kept_files);
    out.List("sensors", [&] {
      for (const SensorOutcome& sensor : outcome.sensors) out.Object([&] { WriteSensor(out, sensor); });
    });
    if (outcome.moments) WriteMoments(out, *outcome.moments);
    if (outcome.shows_no_board) out.Flag("shows_no_board", true);
    WriteDamage(out, outcome.damage);
  });
}

Result<ImportOutcome> ReadOutcome(const std::string& text) {
  const formats::JsonKind kind{"what an import kept of its outcome", "Remove its folder, and import the bag again.",
                               kOutcomeBytesMax};
  RIGCAL_ASSIGN(auto document, formats::JsonDocument::Parse(text, kind));
  const formats::JsonField root = document.Root();
  ImportOutcome outcome;
  outcome.captures = static_cast<std::size_t>(CountAt(root, "captures"));
  outcome.tolerance_ns = CountAt(root, "tolerance_ns");
  outcome.kept_files = CountAt(root, "kept_files");
  outcome.was_complete = root.At("was_complete").Flag();
  for (const auto& sensor : root.At("sensors").Items(kOutcomeListMax)) outcome.sensors.push_back(SensorAt(sensor));
  if (root.Find("moments")) outcome.moments = MomentsAt(root);
  if (const auto shows_none = root.Find("shows_no_board")) outcome.shows_no_board = shows_none->Flag();
  for (const auto& error : root.At("damage").Items(kOutcomeListMax)) outcome.damage.push_back(ErrorAt(error));
  RIGCAL_TRY(document.status());
  return outcome;
}

}  // namespace rigcal::importing
