#include "server/formats/revision/policy_fields.h"

#include <climits>

#include "server/base/limits.h"
#include "server/formats/json/json_values.h"
#include "server/model/graph/pose_results.h"

namespace rigcal::formats {
namespace {

std::string StoredKeyOf(const LimitName& name) { return std::string(name.name) + "_" + name.kept; }

void WriteLimitWords(JsonWriter& out, const LimitWords& words) {
  for (const LimitName& one : kLimitNames)
    if (words.*one.value) out.Number(StoredKeyOf(one), *(words.*one.value));
  if (!words.not_needed) return;
  out.List("not_needed", [&] {
    for (const std::string& result : *words.not_needed) out.Text(result);
  });
}

// 0 or less is no limit: documents were written with it, and stay readable.
std::optional<double> ReadAboveZero(const JsonField& field) {
  const double value = field.Number();
  return value > 0.0 ? std::optional(value) : std::nullopt;
}

LimitWords ReadLimitWords(const JsonField& field) {
  LimitWords words;
  for (const LimitName& one : kLimitNames)
    if (const auto value = field.Find(StoredKeyOf(one))) words.*one.value = ReadAboveZero(*value);
  if (const auto results = field.Find("not_needed")) {
    words.not_needed.emplace();
    for (const JsonField& result : results->Items(kNotNeededMax)) words.not_needed->insert(result.Text());
  }
  return words;
}

void WriteLimitsOfSome(JsonWriter& out, const Policy& policy) {
  out.List("sensors", [&] {
    for (const auto& [sensor, words] : policy.sensors)
      out.Object([&] {
        out.Text("id", sensor.str());
        WriteLimitWords(out, words);
      });
  });
  out.List("pairs", [&] {
    for (const auto& [pair, words] : policy.pairs)
      out.Object([&] {
        out.Text("a", pair.a.str());
        out.Text("b", pair.b.str());
        WriteLimitWords(out, words);
      });
  });
  out.List("focal_px", [&] {
    for (const auto& [camera, focal] : policy.focal_px)
      out.Object([&] {
        out.Text("id", camera.str());
        out.Number("fx_px", focal);
      });
  });
}

void ReadLimitsOfSome(const JsonField& field, Policy& policy) {
  for (const JsonField& sensor : field.At("sensors").Items(limits::kSensorsPerRobotMax))
    policy.sensors[ReadId<SensorId>(sensor.At("id"))] = ReadLimitWords(sensor);
  for (const JsonField& pair : field.At("pairs").Items(limits::kSensorsPerRobotMax))
    policy.pairs[{ReadId<SensorId>(pair.At("a")), ReadId<SensorId>(pair.At("b"))}] = ReadLimitWords(pair);
  for (const JsonField& camera : field.At("focal_px").Items(limits::kSensorsPerRobotMax))
    if (const auto focal = ReadAboveZero(camera.At("fx_px")))
      policy.focal_px[ReadId<SensorId>(camera.At("id"))] = *focal;
}

}  // namespace

void WritePolicyMembers(JsonWriter& out, const PolicyInForce& in_force) {
  const Policy& policy = in_force.policy;
  out.Object("versions", [&] {
    out.Integer("fleet", in_force.fleet);
    out.Integer("model", in_force.model);
    out.Integer("robot", in_force.robot);
  });
  in_force.rig_model.empty() ? out.Null("rig_model") : out.Text("rig_model", in_force.rig_model);
  if (in_force.rig_model_version > 0) out.Integer("rig_model_version", in_force.rig_model_version);
  out.Object("all", [&] { WriteLimitWords(out, policy.all); });
  WriteLimitsOfSome(out, policy);
  if (policy.residual_max_m) out.Number("residual_max_m", *policy.residual_max_m);
  if (policy.residual_max_rad) out.Number("residual_max_rad", *policy.residual_max_rad);
  if (policy.max_age_ns) out.Integer("max_age_ns", *policy.max_age_ns);
  if (policy.captures_min) out.Integer("captures_min", *policy.captures_min);
  if (policy.approval) out.Text("approval", NameOf(*policy.approval));
  if (policy.approve_warnings) out.Flag("approve_warnings", *policy.approve_warnings);
  if (policy.approve_drift) out.Flag("approve_drift", *policy.approve_drift);
  if (policy.drift_false_alarm_ratio) out.Number("drift_false_alarm_ratio", *policy.drift_false_alarm_ratio);
  if (policy.visits_in_full) out.Integer("visits_in_full", *policy.visits_in_full);
}

PolicyInForce ReadPolicyMembers(const JsonField& field) {
  PolicyInForce in_force;
  const JsonField versions = field.At("versions");
  in_force.fleet = versions.At("fleet").Integer(0, INT64_MAX);
  in_force.model = versions.At("model").Integer(0, INT64_MAX);
  in_force.robot = versions.At("robot").Integer(0, INT64_MAX);
  if (const auto model = field.Find("rig_model")) in_force.rig_model = model->Text();
  if (const auto version = field.Find("rig_model_version")) in_force.rig_model_version = version->Integer(0, INT64_MAX);
  Policy& policy = in_force.policy;
  policy.all = ReadLimitWords(field.At("all"));
  ReadLimitsOfSome(field, policy);
  if (const auto value = field.Find("residual_max_m")) policy.residual_max_m = ReadAboveZero(*value);
  if (const auto value = field.Find("residual_max_rad")) policy.residual_max_rad = ReadAboveZero(*value);
  if (const auto value = field.Find("max_age_ns"))
    if (const std::int64_t age_ns = value->Integer(INT64_MIN, INT64_MAX); age_ns > 0) policy.max_age_ns = age_ns;
  if (const auto value = field.Find("captures_min")) policy.captures_min = value->Integer(1, INT64_MAX);
  if (const auto value = field.Find("approval")) policy.approval = ApprovalByOf(value->Text());
  if (const auto value = field.Find("approve_warnings")) policy.approve_warnings = value->Flag();
  if (const auto value = field.Find("approve_drift")) policy.approve_drift = value->Flag();
  if (const auto value = field.Find("drift_false_alarm_ratio")) policy.drift_false_alarm_ratio = ReadAboveZero(*value);
  if (const auto value = field.Find("visits_in_full"))
    policy.visits_in_full = value->Integer(kVisitsInFullMin, kVisitsInFullMax);
  return in_force;
}

}  // namespace rigcal::formats
