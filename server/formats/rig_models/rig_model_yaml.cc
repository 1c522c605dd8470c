#include "server/formats/rig_models/rig_model_yaml.h"

#include <algorithm>

#include "server/base/text.h"
#include "server/formats/yaml/yaml_values.h"

namespace rigcal::formats {
namespace {

constexpr const char* kRigModelCure = "Mend the file; docs/rig-models.md has a complete example.";
constexpr double kToleranceMax_mm = 10'000, kToleranceMax_deg = 180;

Se3 ReadDrawnPose(const YamlField& field) {
  field.AllowOnly({"p_m", "q_xyzw"});
  Se3 T;
  field.At("p_m").Numbers(T.p_m.data(), 3);
  if (const auto quaternion = field.Find("q_xyzw")) T.q = ReadQuaternion(*quaternion);
  return T.Normalized();
}

double ReadAboveZeroUpTo(const YamlField& field, double most) {
  const double value = field.Number();
  if (!(value > 0.0 && value <= most))
    field.Refuse("must be above 0, and at most " + std::to_string(static_cast<int>(most)));
  return value;
}

// What is said at `map`, else what holds otherwise.
PoseLimit ReadTolerance(const YamlField& map, PoseLimit otherwise) {
  if (const auto mm = map.Find("tolerance_mm")) otherwise.m = ReadAboveZeroUpTo(*mm, kToleranceMax_mm) / 1000;
  if (const auto deg = map.Find("tolerance_deg"))
    otherwise.rad = ReadAboveZeroUpTo(*deg, kToleranceMax_deg) / kDegreesOfRadian;
  return otherwise;
}

ExpectedSensor ReadExpected(const YamlField& field, const PoseLimit& otherwise) {
  field.AllowOnly({"type", "T_ref_sensor", "tolerance_mm", "tolerance_deg"});
  ExpectedSensor sensor;
  const auto id = SensorId::Parse(field.Key());
  if (!id) field.Refuse(id.error().what, id.error().cure);
  sensor.id = id.value_or(SensorId());
  sensor.kind = ReadNamed(field.At("type"), SensorKindOf, sensor.kind);
  if (const auto T = field.Find("T_ref_sensor")) sensor.T_ref_sensor = ReadDrawnPose(*T);
  const PoseLimit tolerance = ReadTolerance(field, otherwise);
  if (sensor.T_ref_sensor) sensor.tolerance = tolerance;
  const bool says_tolerance = field.Find("tolerance_mm") || field.Find("tolerance_deg");
  if (says_tolerance && !sensor.T_ref_sensor)
    field.Refuse("a tolerance is given without T_ref_sensor", "Give both, or none.");
  return sensor;
}

SensorPair ReadRequiredPair(const YamlField& field) {
  const std::vector<YamlField> names = field.Items();
  if (names.size() == 2) return {ReadId<SensorId>(names[0]), ReadId<SensorId>(names[1])};
  field.Refuse("must be two names of sensors, [a, b]");
  return {};
}

SensorId ReferenceOf(const YamlField& root, const RigModel& model) {
  if (const auto named = root.Find("reference")) return ReadId<SensorId>(*named);
  const auto undrawn = std::find_if(model.sensors.begin(), model.sensors.end(),
                                    [](const ExpectedSensor& sensor) { return !sensor.T_ref_sensor; });
  if (undrawn != model.sensors.end()) return undrawn->id;
  root.At("sensors").Refuse("every sensor has T_ref_sensor",
                            "Name the one in which they are as reference, and give it none.");
  return {};
}

void PlaceReference(RigModel& model) {
  const bool any_drawn = std::any_of(model.sensors.begin(), model.sensors.end(),
                                     [](const ExpectedSensor& sensor) { return sensor.T_ref_sensor.has_value(); });
  for (ExpectedSensor& sensor : model.sensors)
    if (any_drawn && sensor.id == model.reference && !sensor.T_ref_sensor) sensor.T_ref_sensor = Se3();
}

RigModel ReadModelAt(const YamlField& root) {
  root.AllowOnly({"rig_model", "reference", "tolerance_mm", "tolerance_deg", "sensors", "required_pairs"});
  RigModel model;
  model.name = root.At("rig_model").Text();
  const PoseLimit tolerance = ReadTolerance(root, {0.0, 0.0});
  const YamlField sensors = root.At("sensors");
  for (const YamlField& sensor : sensors.Members())
    model.sensors.push_back(ReadExpected(sensor.Called("sensor " + Quoted(sensor.Key())), tolerance));
  if (const auto pairs = root.Find("required_pairs"))
    for (const YamlField& pair : pairs->Items()) model.required_pairs.push_back(ReadRequiredPair(pair));
  if (!model.sensors.empty()) model.reference = ReferenceOf(root, model);
  PlaceReference(model);
  return model;
}

}  // namespace

Result<RigModel> ReadRigModel(std::string_view text, const std::string& name) {
  RIGCAL_ASSIGN(const std::unique_ptr<YamlTree> tree, ParseYaml(text, name, kRigModelCure, kRigModelBytesMax));
  const YamlField root(*tree);
  RigModel model = ReadModelAt(root);
  if (tree->error) return Fail(*tree->error);
  if (const Status valid = Validate(model); !valid)
    return Fail(valid.error().code, name + ": " + valid.error().what, valid.error().cure);
  return model;
}

}  // namespace rigcal::formats
