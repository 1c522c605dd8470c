#include "server/model/robots/rig_model.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/base/limits.h"
#include "server/base/text.h"
#include "server/model/named.h"
#include "server/model/plausible.h"

namespace rigcal {
namespace {

constexpr std::size_t kModelNameBytesMax = 1024;  // as of a session
constexpr std::size_t kRequiredPairsMax = 65'536;

tl::unexpected<Error> RefuseSensor(const ExpectedSensor& sensor, const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, "sensor " + sensor.id.str() + ": " + what, cure);
}

Status CheckDrawn(const ExpectedSensor& sensor, bool is_reference) {
  if (!sensor.T_ref_sensor) return {};
  const Se3& T = *sensor.T_ref_sensor;
  if (const Status good = CheckGivenPose(T); !good) return RefuseSensor(sensor, good.error().what, good.error().cure);
  if (is_reference && T == Se3()) return {};
  if (is_reference)
    return RefuseSensor(sensor, "its pose is in itself, as it is the reference", "Leave T_ref_sensor away.");
  const bool has_limits = sensor.tolerance.m > 0.0 && sensor.tolerance.rad > 0.0 && std::isfinite(sensor.tolerance.m) &&
                          std::isfinite(sensor.tolerance.rad);
  if (has_limits) return {};
  return RefuseSensor(sensor, "its pose has no tolerance",
                      "Give tolerance_mm and tolerance_deg, of the sensor or of the whole model.");
}

Status CheckRequiredPair(const RigModel& model, const SensorPair& pair) {
  const auto has = [&](const SensorId& id) { return SensorOf(model, id) != nullptr; };
  return CheckPairIn("required_pairs", pair, has, "a sensor of the model", "Name two of its sensors.");
}

}  // namespace

Status Validate(const RigModel& model) {
  if (model.name.empty() || model.name.size() > kModelNameBytesMax || !IsPrintableUtf8(model.name))
    return Fail(ErrorCode::kInvalidInput, Quoted(model.name) + " is no name of a rig model",
                "Give what session.yaml has as rig_model.");
  if (model.sensors.empty() || model.sensors.size() > limits::kSensorsPerSessionMax)
    return Fail(ErrorCode::kInvalidInput, "the model has " + std::to_string(model.sensors.size()) + " sensors",
                "Give 1 to " + std::to_string(limits::kSensorsPerSessionMax) + ".");
  if (SensorOf(model, model.reference) == nullptr)
    return Fail(ErrorCode::kInvalidInput,
                "reference " + Quoted(model.reference.str()) + " is not a sensor of the model",
                "Name one of its sensors.");
  if (model.required_pairs.size() > kRequiredPairsMax)
    return Fail(ErrorCode::kInvalidInput,
                "the model has " + std::to_string(model.required_pairs.size()) + " required pairs",
                "Give at most " + std::to_string(kRequiredPairsMax) + ".");
  std::set<SensorId> names;
  for (const ExpectedSensor& sensor : model.sensors) {
    RIGCAL_TRY(CheckName(SensorTag::kKind, sensor.id.str()));
    if (!names.insert(sensor.id).second)
      return RefuseSensor(sensor, "it is there twice", "Give every sensor its own name.");
    RIGCAL_TRY(CheckDrawn(sensor, sensor.id == model.reference));
  }
  for (const SensorPair& pair : model.required_pairs) RIGCAL_TRY(CheckRequiredPair(model, pair));
  return {};
}

const ExpectedSensor* SensorOf(const RigModel& model, const SensorId& id) { return FindById(model.sensors, id); }

std::optional<Se3> NominalPose(const RigModel& model, const SensorId& from, const SensorId& sensor) {
  const ExpectedSensor *a = SensorOf(model, from), *b = SensorOf(model, sensor);
  if (a == nullptr || b == nullptr || !a->T_ref_sensor || !b->T_ref_sensor) return std::nullopt;
  return a->T_ref_sensor->Inverse() * *b->T_ref_sensor;
}

}  // namespace rigcal
