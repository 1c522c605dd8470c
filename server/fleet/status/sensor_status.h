// What a revision says of the status of its robot, sensor by sensor, whatever the time (model/robots/robot_status.h).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/fleet/status/drift_forecast.h"
#include "server/model/graph/graph.h"
#include "server/model/robots/robot_status.h"
#include "server/model/sessions/as_found.h"

namespace rigcal::fleet {

using DriftSteps = std::map<SensorId, std::vector<DriftStep>>;

// The steps that an as-found test tells, of each sensor that it measured: `days` since the calibration in use was
// measured. None of a test against a single visit whose sigma is partly the policy's: where other robots do not tell
// what visits scatter by.
void AddSteps(const RobotId& robot, const AsFound& found, double days, DriftSteps& steps);

struct StatusInput {
  // What the revision's verdict says of sensors.
  struct Judged {
    VerdictLevel level = VerdictLevel::kPass;
    const VerdictBasis& basis;
  };
  RobotId robot;
  const GraphSolution& solution;
  SensorId reference;
  const Policy& policy;
  const std::optional<AsFound>& found;  // by the newest session of the revision
  const DriftSteps& steps;              // of the robots of its rig model
  std::optional<Stamp> calibrated_at;   // of the revision
  std::int64_t max_age_ns = kDefaultMaxAge_ns;
  std::optional<Stamp> in_use_captured_at = {};  // what `found` was held against; when it was solved is no date of it
  std::optional<Judged> judged = {};
};
// `site` is left empty. Of a sensor the first of: out-of-tolerance as it was found moved, drifted, failed (the verdict
// fails, and it has two poses or is accused), unknown (no pose), out-of-tolerance as its pose is less certain than the
// tolerance (any axis, 1 sigma), unknown as the verdict does not rely on it,
// drifted as it goes on drifting from visit to visit (DriftingOf; by more than the least move in the age that is
// allowed), ok.
[[nodiscard]] StatusFacts JudgeStatus(const StatusInput& input);

}  // namespace rigcal::fleet
