#include "server/formats/rig_models/rig_model_answers.h"

#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

void WriteExpectedSensor(JsonWriter& out, const ExpectedSensor& sensor) {
  out.Text("id", sensor.id.str());
  out.Text("type", NameOf(sensor.kind));
  sensor.T_ref_sensor ? WritePose(out, "T_ref_sensor", *sensor.T_ref_sensor) : out.Null("T_ref_sensor");
  const bool has_limits = sensor.tolerance.m > 0.0;
  has_limits ? out.Number("tolerance_m", sensor.tolerance.m) : out.Null("tolerance_m");
  has_limits ? out.Number("tolerance_rad", sensor.tolerance.rad) : out.Null("tolerance_rad");
}

void WriteModelMembers(JsonWriter& out, const RigModel& model) {
  out.Text("rig_model", model.name);
  out.Text("reference", model.reference.str());
  out.List("sensors", [&] {
    for (const ExpectedSensor& sensor : model.sensors) out.Object([&] { WriteExpectedSensor(out, sensor); });
  });
  out.List("required_pairs", [&] {
    for (const SensorPair& pair : model.required_pairs)
      out.List([&] {
        out.Text(pair.a.str());
        out.Text(pair.b.str());
      });
  });
}

void WriteModelVersion(JsonWriter& out, const RigModelVersion& version) {
  out.Text("rig_model", version.name);
  out.Integer("version", version.version);
  WriteWord(out, version.word);
  out.Text("text", version.text);
}

}  // namespace

std::string WriteRigModel(const RigModelAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    out.Object("model", [&] { WriteModelMembers(out, answer.model); });
    out.Object("set", [&] { WriteModelVersion(out, answer.set); });
    out.Integer("robots", answer.robots);
  });
}

std::string WriteRigModels(const std::vector<RigModelRow>& rows) {
  return WriteObject([&](JsonWriter& out) {
    out.List("rig_models", [&] {
      for (const RigModelRow& row : rows)
        out.Object([&] {
          out.Text("rig_model", row.name);
          row.version > 0 ? out.Integer("version", row.version) : out.Null("version");
          out.Integer("robots", row.robots);
        });
    });
  });
}

std::string WriteRigModelSet(const RigModelVersion& set, std::int64_t robots_waiting) {
  return WriteObject([&](JsonWriter& out) {
    out.Null("robot");
    out.Object("set", [&] { WriteModelVersion(out, set); });
    out.Integer("robots_waiting", robots_waiting);
    out.Flag("revision_follows", false);
  });
}

std::string WriteRigModelCheck(const std::string& file, const RigModel& model) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("file", file);
    out.Object("model", [&] { WriteModelMembers(out, model); });
  });
}

std::string WriteEpochBegun(const EpochAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", answer.robot.str());
    WriteIds(out, "sensors", answer.sensors);
    WriteStamp(out, "begins_at", answer.begins_at);
    out.Flag("taken_back", answer.taken_back);
    out.Object("standing", [&] {
      out.Integer("number", answer.standing);
      WriteWord(out, answer.word);
    });
    out.Flag("revision_follows", answer.has_edges);
  });
}

void WriteEpochs(JsonWriter& out, const std::vector<Epoch>& epochs) {
  if (epochs.empty()) return;
  out.List("epochs", [&] {
    for (auto epoch = epochs.rbegin(); epoch != epochs.rend(); ++epoch)
      out.Object([&] {
        out.Text("sensor", epoch->sensor.str());
        WriteStamp(out, "begins_at", epoch->begins_at);
        out.Text("cause", NameOf(epoch->cause));
        out.Text("text", TextOf(*epoch));
        epoch->session.empty() ? out.Null("session") : out.Text("session", epoch->session.str());
        epoch->word.who.empty() ? out.Null("who") : out.Text("who", epoch->word.who);
        epoch->word.who.empty() ? out.Null("reason") : out.Text("reason", epoch->word.reason);
      });
  });
}

}  // namespace rigcal::formats
