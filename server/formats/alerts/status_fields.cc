#include "server/formats/alerts/status_fields.h"

#include <climits>

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"
#include "server/formats/revision/verdict_basis_fields.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kStatusFactsBytesMax = 16u << 20;

void WriteWords(JsonWriter& out, const CalibrationStatus& status) {
  out.Text("word", NameOf(status.word));
  out.Text("why", status.why);
  out.Text("next_step", status.next_step);
}

void WriteDriftDue(JsonWriter& out, std::string_view key, const std::optional<DriftDue>& due) {
  if (!due) return out.Null(key);
  out.Object(key, [&] {
    WriteStamp(out, "at", due->at);
    out.Text("sensor", due->sensor.str());
    out.Text("law", NameOf(due->law));
    out.Integer("visits", due->visits);
    out.Integer("robots", due->robots);
  });
}

// Null where it is not known.
void WriteName(JsonWriter& out, std::string_view key, const std::string& name) {
  name.empty() ? out.Null(key) : out.Text(key, name);
}

DriftDue ReadDriftDue(const JsonField& field) {
  return {ReadId<SensorId>(field.At("sensor")), ReadStamp(field.At("at")), DriftLawOf(field.At("law").Text()),
          static_cast<int>(field.At("visits").Integer(0, INT_MAX)),
          static_cast<int>(field.At("robots").Integer(0, INT_MAX))};
}

SensorStatus ReadSensorStatus(const JsonField& field) {
  SensorStatus sensor;
  sensor.sensor = ReadId<SensorId>(field.At("id"));
  sensor.status = {StatusWordOf(field.At("word").Text()), field.At("why").Text(), field.At("next_step").Text()};
  if (const auto due = field.Find("drift_due")) sensor.due = ReadDriftDue(*due);
  return sensor;
}

}  // namespace

void WriteCalibrationStatus(JsonWriter& out, const CalibrationStatus& status) {
  out.Object("status", [&] { WriteWords(out, status); });
}

void WriteDueMember(JsonWriter& out, const Validity& validity, const std::optional<DriftDue>& drift_due) {
  const std::optional<Stamp> at = DueAt(validity, drift_due);
  if (!at) return out.Null("due");
  out.Object("due", [&] {
    WriteStamp(out, "at", at);
    WriteStamp(out, "by_age_at", ValidUntil(validity));
    WriteDriftDue(out, "by_drift", drift_due);
    out.Text("text", DueText(validity, drift_due));
  });
}

void WriteStatusMembers(JsonWriter& out, const RobotSummary& robot, Stamp now) {
  WriteCalibrationStatus(out, StatusAt(robot, now));
  WriteDueMember(out, robot.validity, robot.drift_due);
  WriteName(out, "site", robot.site);
  WriteName(out, "rig_model", robot.rig_model);
  WriteName(out, "operator", robot.operator_name);
  if (robot.sensors.empty()) return;
  out.List("sensors", [&] {
    for (const SensorStatus& sensor : robot.sensors)
      out.Object([&] {
        out.Text("id", sensor.sensor.str());
        WriteCalibrationStatus(out, StatusAt(sensor, robot.validity, now));
        WriteDueMember(out, robot.validity, sensor.due);
      });
  });
}

std::string WriteStatusFacts(const StatusFacts& facts) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("site", facts.site);
    WriteVerdictBasis(out, facts.basis);
    out.List("sensors", [&] {
      for (const SensorStatus& sensor : facts.sensors)
        out.Object([&] {
          out.Text("id", sensor.sensor.str());
          WriteWords(out, sensor.status);
          if (sensor.due) WriteDriftDue(out, "drift_due", sensor.due);
        });
    });
  });
}

Result<StatusFacts> ReadStatusFacts(std::string_view text) {
  const JsonKind kind = {"status", "Run `rigcal doctor`: the store is damaged.", kStatusFactsBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  const JsonField root = document.Root();
  StatusFacts facts;
  facts.site = root.At("site").Text();
  facts.basis = ReadVerdictBasis(root);
  for (const JsonField& sensor : root.At("sensors").Items(limits::kSensorsPerRobotMax))
    facts.sensors.push_back(ReadSensorStatus(sensor));
  RIGCAL_TRY(document.status());
  return facts;
}

}  // namespace rigcal::formats
