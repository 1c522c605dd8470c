#include "server/formats/answers/sensor_facts.h"

#include <limits>

#include "server/base/limits.h"
#include "server/formats/edges/camera_fit.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kSensorFactsBytesMax = 256u << 20;

void WriteOneSensor(JsonWriter& out, const SensorFacts& sensor) {
  out.Text("id", sensor.sensor.str());
  sensor.kind ? out.Text("kind", NameOf(*sensor.kind)) : out.Null("kind");
  if (!sensor.camera) {
    out.Null("camera");
    return out.Null("edge");
  }
  out.Text("edge", sensor.edge.str());
  if (!sensor.refined_in.empty()) out.Text("refined_in", sensor.refined_in.str());
  out.Object("camera", [&] { WriteCameraFitMembers(out, *sensor.camera); });
}

SensorFacts ReadOneSensor(const JsonField& field) {
  SensorFacts sensor;
  sensor.sensor = ReadId<SensorId>(field.At("id"));
  if (const auto kind = field.Find("kind")) {
    const auto known = SensorKindOf(kind->Text());
    if (known) sensor.kind = *known;
  }
  if (const auto camera = field.Find("camera")) {
    sensor.camera = ReadCameraFitMembers(*camera);
    sensor.edge = ReadOptionalId<EdgeId>(field, "edge");
    sensor.refined_in = ReadOptionalId<SessionId>(field, "refined_in");
  }
  return sensor;
}

}  // namespace

std::string WriteSensorFacts(const SensorFactsOfRevision& facts) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("robot", facts.robot.str());
    WriteRevisionNumber(out, facts.revision);
    out.List("sensors", [&] {
      for (const SensorFacts& sensor : facts.sensors) out.Object([&] { WriteOneSensor(out, sensor); });
    });
  });
}

Result<SensorFactsOfRevision> ReadSensorFacts(std::string_view text) {
  const JsonKind kind = {"the server's answer to 'sensors'",
                         "Check with `rigcal doctor` that client and server are of the same version.",
                         kSensorFactsBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  const JsonField root = document.Root();
  SensorFactsOfRevision facts;
  facts.robot = ReadId<RobotId>(root.At("robot"));
  facts.revision = static_cast<int>(root.At("revision").Integer(1, std::numeric_limits<int>::max()));
  for (const JsonField& sensor : root.At("sensors").Items(limits::kSensorsPerRobotMax))
    facts.sensors.push_back(ReadOneSensor(sensor));
  RIGCAL_TRY(document.status());
  return facts;
}

}  // namespace rigcal::formats
