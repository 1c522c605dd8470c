// Policies that people set: for whom, by whom, as they were written; and which of them hold for a robot.
#pragma once

#include <cstdint>
#include <string>

#include "server/model/approval/policy.h"
#include "server/model/approval/standing.h"

namespace rigcal {

enum class PolicyScope { kFleet, kModel, kRobot };  // "fleet" | "model" | "robot"; each goes before those before it
// The spelling in documents, and back; any other name is the fleet.
[[nodiscard]] std::string NameOf(PolicyScope scope);
[[nodiscard]] PolicyScope PolicyScopeOf(const std::string& name);

struct PolicyPlace {
  PolicyScope scope = PolicyScope::kFleet;
  std::string subject;  // rig model or robot; empty of the fleet
  friend bool operator==(const PolicyPlace&, const PolicyPlace&) = default;
};
// "the fleet", "rig model mars", "robot mapper-01"
[[nodiscard]] std::string TextOf(const PolicyPlace& place);

struct PolicyVersion {
  PolicyPlace place;
  std::int64_t number = 0;   // order of arrival among those of all places
  std::int64_t version = 0;  // of its place, from 1
  Word word;
  std::string text;  // YAML
};

// What a robot is judged by.
struct PolicyInForce {
  Policy policy;
  std::string rig_model;                         // as its newest session says; empty: none does
  std::int64_t fleet = 0, model = 0, robot = 0;  // versions; 0: nobody has set one
  std::int64_t rig_model_version = 0;            // of the rig model as it was set (rig_model.h); 0: nobody has set it
  std::int64_t watermark = 0;                    // number of the newest of all: what was set later is not in it
};

}  // namespace rigcal
