#include "server/model/approval/policy_version.h"

namespace rigcal {

std::string NameOf(PolicyScope scope) {
  if (scope == PolicyScope::kFleet) return "fleet";
  return scope == PolicyScope::kModel ? "model" : "robot";
}

PolicyScope PolicyScopeOf(const std::string& name) {
  if (name == "model") return PolicyScope::kModel;
  return name == "robot" ? PolicyScope::kRobot : PolicyScope::kFleet;
}

std::string TextOf(const PolicyPlace& place) {
  if (place.scope == PolicyScope::kFleet) return "the fleet";
  return (place.scope == PolicyScope::kModel ? "rig model " : "robot ") + place.subject;
}

}  // namespace rigcal
