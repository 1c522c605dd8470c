// Poses that lack nothing but what the policy says is not needed (`not_needed` in docs/policy.md): a robot that never
// leaves a level floor has no use for the height of a sensor.
#pragma once

#include <optional>
#include <string>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

// The solution as it is judged: such poses are taken as known, with what was measured of them and no error along what
// was not. Nothing where there are none. By `solution.R_ref_robot`, without it by the reference's axes, of which a
// policy says whose they are ("z of left"): with another reference they are others. A pose that is open along no axis
// is never one of them.
[[nodiscard]] std::optional<GraphSolution> TakenAsKnown(const GraphSolution& solution, const Policy& policy);

// Whether the policy does without this axis of the sensor's pose. `axis`: by the same axes as above; without a name
// none.
[[nodiscard]] bool IsNotNeeded(const AxisResult& axis, const SensorId& sensor, const GraphSolution& solution,
                               const Policy& policy);

// "the height of body was not measured, and the policy does not need it; the rest was, to 1.5 mm and 0.05 deg": of
// these poses, without a stop; empty where there are none.
[[nodiscard]] std::string NotNeededRemark(const GraphSolution& solution, const Policy& policy,
                                          const SessionHeaders& headers);

}  // namespace rigcal::fleet
