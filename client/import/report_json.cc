#include "client/import/report.h"
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
    WriteDamage(out, outcome.damage);
  });
}

}  // namespace rigcal::importing
