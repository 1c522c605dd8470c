#include "server/formats/answers/answers.h"
#include "server/formats/json/json_values.h"
#include "server/formats/revision/policy_fields.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::formats {
namespace {

void WritePlace(JsonWriter& out, const PolicyPlace& place) {
  out.Text("scope", NameOf(place.scope));
  place.subject.empty() ? out.Null("subject") : out.Text("subject", place.subject);
}

void WritePolicyVersion(JsonWriter& out, const PolicyVersion& version) {
  WritePlace(out, version.place);
  out.Integer("version", version.version);
  WriteWord(out, version.word);
  out.Text("text", version.text);
}

void WritePoseLimit(JsonWriter& out, const std::string& name, const PoseLimit& limit) {
  out.Number(name + "_m", limit.m);
  out.Number(name + "_rad", limit.rad);
}

// Of a sensor of which nothing is said.
void WriteLimitsInForce(JsonWriter& out, const Policy& policy) {
  const PoseLimits limits = LimitsOf(policy, SensorId());
  WritePoseLimit(out, "tolerance", limits.tolerance);
  WritePoseLimit(out, "moved_min", limits.moved_min);
  WritePoseLimit(out, "unseen_move", limits.unseen_move);
  WritePoseLimit(out, "residual_max", ResidualMaxOf(policy));
  out.Integer("max_age_ns", policy.max_age_ns.value_or(kDefaultMaxAge_ns));
  policy.captures_min ? out.Integer("captures_min", *policy.captures_min) : out.Null("captures_min");
  out.Text("approval", NameOf(policy.approval.value_or(ApprovalBy::kAutomatic)));
  out.Flag("approve_warnings", policy.approve_warnings.value_or(true));
  out.Flag("approve_drift", policy.approve_drift.value_or(true));
  out.Number("drift_false_alarm_ratio", policy.drift_false_alarm_ratio.value_or(kAsFoundAlpha));
  out.Integer("visits_in_full", policy.visits_in_full.value_or(kDefaultVisitsInFull));
}

}  // namespace

std::string WritePolicy(const PolicyAnswer& answer) {
  return WriteObject([&](JsonWriter& out) {
    WritePlace(out, answer.place);
    out.Object("limits", [&] { WriteLimitsInForce(out, answer.in_force.policy); });
    out.Object("policy", [&] { WritePolicyMembers(out, answer.in_force); });
    out.List("set", [&] {
      for (const PolicyVersion& version : answer.set) out.Object([&] { WritePolicyVersion(out, version); });
    });
  });
}

std::string WritePolicySet(const PolicyVersion& set, std::int64_t robots_waiting) {
  return WriteObject([&](JsonWriter& out) {
    const bool of_robot = set.place.scope == PolicyScope::kRobot;
    of_robot ? out.Text("robot", set.place.subject) : out.Null("robot");
    out.Object("set", [&] { WritePolicyVersion(out, set); });
    out.Integer("robots_waiting", robots_waiting);
    out.Flag("revision_follows", of_robot && robots_waiting > 0);
  });
}

std::string WritePolicyCheck(const std::string& file, const Policy& policy) {
  return WriteObject([&](JsonWriter& out) {
    out.Text("file", file);
    out.Object("limits", [&] { WriteLimitsInForce(out, policy); });
    out.Object("policy", [&] { WritePolicyMembers(out, {policy, "", 0, 0, 0, 0}); });
  });
}

}  // namespace rigcal::formats
