// The limits that people set: which hold for a robot, what is told of them, and how they are set.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/order.h"
#include "server/model/approval/policy_version.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ: of the fleet; of the fleet and a rig model; of the fleet, a robot's rig model and the robot. Focal lengths are
// not looked for.
[[nodiscard]] Result<PolicyInForce> LoadPolicyInForce(storage::Store& store, const PolicyPlace& place);

// READ: the focal lengths of cameras, where the policy has a tolerance in pixels: as the newest fit of an edge has it,
// or else as the newest session of `headers` that gives it.
[[nodiscard]] Status TakeFocals(storage::Store& store, const std::vector<Edge>& edges,
                                const std::map<SessionId, SessionHeader>& headers,
                                const std::map<SessionId, Stamp>& captured_at, Policy& policy);

// Verb policy: `robot`, or `model`, or neither for the fleet: what holds, and who set it.
[[nodiscard]] Result<std::string> TellPolicy(storage::Store& store, const formats::Parameters& parameters);

// Order set_policy: `text` (YAML), `who`, `reason`, and `robot`, or `model`, or neither for the fleet. The robots that
// it is for wait to be judged anew. kNotFound where a robot's names a sensor that the robot does not have, and where no
// session is of the rig model, unless `new_model` says that its sessions are to come.
[[nodiscard]] Result<OrderDone> SetPolicy(storage::Store& store, const Clock& clock,
                                          const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
