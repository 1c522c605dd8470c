#include "server/formats/revision/as_found.h"

#include <climits>
#include <limits>

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"

namespace rigcal::formats {
namespace {

constexpr std::size_t kAsFoundBytesMax = 64u << 20, kFoundTextMax = 64u << 10;

// Null of an axis that was not measured, and of a number that is none.
void WriteMeasured(JsonWriter& out, std::string_view key, const SensorFound& sensor, const Vector6d& values) {
  out.List(key, [&] {
    for (int axis = 0; axis < 6; ++axis) IsMeasured(sensor, axis) ? out.Number(values(axis)) : out.Null();
  });
}

Vector6d ReadMeasured(const JsonField& field, double if_null) {
  const std::vector<JsonField> items = field.Items(6);
  if (items.size() != 6) field.Refuse("needs six numbers");
  Vector6d values = Vector6d::Constant(if_null);
  for (std::size_t axis = 0; axis < items.size(); ++axis)
    if (!items[axis].IsNull()) values(static_cast<Eigen::Index>(axis)) = items[axis].Number();
  return values;
}

FoundState ReadFoundState(const JsonField& field) {
  const auto state = FoundStateOf(field.Text());
  if (!state) field.Refuse(state.error().what);
  return state.value_or(FoundState::kNotMeasured);
}

void WriteRate(JsonWriter& out, const DriftRate& rate) {
  out.Object("drift_rate", [&] {
    out.Integer("visits", rate.visits);
    WriteStamp(out, "first", rate.first);
    WriteStamp(out, "last", rate.last);
    WriteVector(out, "per_30_days", rate.per_30_days);
    WriteVector(out, "sigma_per_30_days", rate.sigma_per_30_days);
  });
}

DriftRate ReadRate(const JsonField& field) {
  return {static_cast<int>(field.At("visits").Integer(0, INT_MAX)), ReadStamp(field.At("first")),
          ReadStamp(field.At("last")), ReadVector(field.At("per_30_days")), ReadVector(field.At("sigma_per_30_days"))};
}

void WriteSensorFound(JsonWriter& out, const SensorFound& sensor) {
  out.Object([&] {
    out.Text("id", sensor.sensor.str());
    out.Text("state", NameOf(sensor.state));
    if (!sensor.or_else.empty()) out.Text("or_else", sensor.or_else.str());
    out.List("axes", [&] {
      for (const FoundState axis : sensor.axes) out.Text(NameOf(axis));
    });
    WriteMeasured(out, "change", sensor, sensor.change);
    WriteMeasured(out, "sigma", sensor, sensor.sigma);
    WriteMeasured(out, "smallest", sensor, sensor.smallest);
    if (sensor.left) WriteVector(out, "left", *sensor.left);
    if (sensor.rate) WriteRate(out, *sensor.rate);
    if (sensor.elsewhere) WriteVector(out, "elsewhere", *sensor.elsewhere);
  });
}

// Of an axis that is measured, no smallest change means that none would be seen.
void ForgetUnmeasured(SensorFound& sensor) {
  for (int axis = 0; axis < 6; ++axis)
    if (!IsMeasured(sensor, axis)) sensor.smallest(axis) = 0.0;
}

SensorFound ReadSensorFound(const JsonField& field) {
  SensorFound sensor;
  sensor.sensor = ReadId<SensorId>(field.At("id"));
  sensor.state = ReadFoundState(field.At("state"));
  sensor.or_else = ReadOptionalId<SensorId>(field, "or_else");
  const std::vector<JsonField> axes = field.At("axes").Items(6);
  if (axes.size() != 6) field.At("axes").Refuse("needs six states");
  for (std::size_t axis = 0; axis < axes.size(); ++axis) sensor.axes[axis] = ReadFoundState(axes[axis]);
  sensor.change = ReadMeasured(field.At("change"), 0.0);
  sensor.sigma = ReadMeasured(field.At("sigma"), 0.0);
  sensor.smallest = ReadMeasured(field.At("smallest"), std::numeric_limits<double>::infinity());
  ForgetUnmeasured(sensor);
  if (const auto left = field.Find("left")) sensor.left = ReadVector(*left);
  if (const auto rate = field.Find("drift_rate")) sensor.rate = ReadRate(*rate);
  if (const auto elsewhere = field.Find("elsewhere")) sensor.elsewhere = ReadVector(*elsewhere);
  return sensor;
}

void WriteInUse(JsonWriter& out, const AsFound& found) {
  if (found.in_use == 0) return out.Null("in_use");
  out.Object("in_use", [&] {
    out.Integer("revision", found.in_use);
    WriteStamp(out, "created_at", found.made_at);
  });
}

void WriteTested(JsonWriter& out, const AsFound& found) {
  out.Number("alpha", found.alpha);
  out.Integer("tests", found.tests);
  out.Integer("visits", found.visits);
  if (found.scatter_robots > 0) out.Integer("scatter_robots", found.scatter_robots);
  found.relative_to.empty() ? out.Null("relative_to") : out.Text("relative_to", found.relative_to.str());
  if (found.elsewhere) WriteVector(out, "elsewhere", *found.elsewhere);
  const bool tested = found.tests > 0;
  tested ? out.Number("smallest_m", SmallestSeen_m(found)) : out.Null("smallest_m");
  tested ? out.Number("smallest_rad", SmallestSeen_rad(found)) : out.Null("smallest_rad");
  out.List("sensors", [&] {
    for (const SensorFound& sensor : found.sensors) WriteSensorFound(out, sensor);
  });
}

void ReadTested(const JsonField& root, AsFound& found) {
  found.alpha = root.At("alpha").Number();
  found.tests = static_cast<int>(root.At("tests").Integer(0, INT_MAX));
  found.visits = static_cast<int>(root.At("visits").Integer(0, INT_MAX));
  if (const auto robots = root.Find("scatter_robots"))
    found.scatter_robots = static_cast<int>(robots->Integer(0, INT_MAX));
  found.relative_to = ReadOptionalId<SensorId>(root, "relative_to");
  if (const auto elsewhere = root.Find("elsewhere")) found.elsewhere = ReadVector(*elsewhere);
  for (const JsonField& sensor : root.At("sensors").Items(limits::kSensorsPerRobotMax))
    found.sensors.push_back(ReadSensorFound(sensor));
}

}  // namespace

void WriteAsFoundMembers(JsonWriter& out, const AsFound& found) {
  out.Text("session", found.session.str());
  WriteStamp(out, "captured_at", found.captured_at);
  WriteInUse(out, found);
  out.Text("state", NameOf(StateOf(found)));
  found.why_not.empty() ? out.Null("why_not") : out.Text("why_not", found.why_not);
  WriteTested(out, found);
  out.Text("text", found.text);
}

void WriteAsFoundMembers(JsonWriter& out, const AsFoundSummary& summary) {
  out.Text("session", summary.session.str());
  out.Text("state", NameOf(summary.state));
  WriteIds(out, "drifted", summary.drifted);
}

std::string WriteAsFound(const AsFound& found) {
  return WriteObject([&](JsonWriter& out) { WriteAsFoundMembers(out, found); });
}

Result<AsFound> ReadAsFound(std::string_view text) {
  const JsonKind kind = {"as found", "Run `rigcal doctor`: the store is damaged.", kAsFoundBytesMax};
  RIGCAL_ASSIGN(JsonDocument document, JsonDocument::Parse(text, kind));
  const JsonField root = document.Root();
  AsFound found;
  found.session = ReadId<SessionId>(root.At("session"));
  found.captured_at = ReadStamp(root.At("captured_at"));
  if (const auto in_use = root.Find("in_use")) {
    found.in_use = static_cast<int>(in_use->At("revision").Integer(1, INT_MAX));
    if (const auto made_at = in_use->Find("created_at")) found.made_at = ReadStamp(*made_at);
  }
  if (const auto why_not = root.Find("why_not")) found.why_not = why_not->Text(kFoundTextMax);
  ReadTested(root, found);
  found.text = root.At("text").Text(kFoundTextMax);
  RIGCAL_TRY(document.status());
  return found;
}

}  // namespace rigcal::formats
