// What a robot's calibration lacks of its rig model: sensors, kinds, pairs, places. A cause each, which warns and
// decides nothing else.
#pragma once

#include "server/fleet/causes/root_causes.h"

namespace rigcal::fleet {

// After FindExchanged and FindFarFromNominal: what these tell is not told again. Of sensors that were retired from the
// robot nobody asks. Sensors that the model does not have are nobody's business.
void FindSensorsMissing(CauseSearch& search);  // kSensorMissing, kSensorKind
void FindPairsMissing(CauseSearch& search);    // kPairMissing
// Poses farther from the drawing than the model's tolerance, seen from the robot's reference. A reference that is not
// in the drawing is told, as then nothing is held against it.
void FindOffRigModel(CauseSearch& search);  // kOffRigModel, kReferenceNotDrawn

// Sensors of the model that a session does not list, for the page of that session: "imu_front is in rig model mars but
// not here"; without a stop, empty where there is none.
[[nodiscard]] std::string LackingOf(const SessionHeader& header, const RigModel& model,
                                    const std::set<SensorId>& retired);

}  // namespace rigcal::fleet
