// Sensors where they were measured, and where the drawing has them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {

// A sensor that the drawing has, and of which a pose is known, whole or in part; both poses in the reference.
struct Placed {
  SensorId sensor;
  SensorKind kind = SensorKind::kCamera;
  Se3 measured, drawn;
  double sigma_m = 0.0;  // of the measured place, the worst axis
  // Along these nobody measured it, and `measured` holds what it was started from: right tangents at the sensor, m and
  // rad.
  std::vector<Vector6d> open = {};
};

struct PlaceLimit {
  double place_m = 0.0, turn_rad = 0.0;
};
// From where on a sensor is elsewhere than a drawing that means to be exact; alone that is no fault.
constexpr PlaceLimit kExactly{0.05, 5 / kDegreesPerRadian};
// What is asked of a drawing (docs/session-format.md).
constexpr PlaceLimit kRoughly{0.5, 10 / kDegreesPerRadian};

// By the axes of the reference (m), and the turn from the one to the other (rad).
[[nodiscard]] Vector6d Away(const Se3& drawn, const Se3& measured);
// Of the poses that a sensor may have for all that was measured of it, that which is nearest to a place, in limits. So
// what is open neither accuses nor clears anybody.
[[nodiscard]] Se3 NearestTo(const Placed& placed, const Se3& place, const PlaceLimit& limit = kExactly);
// How far a sensor is from a place, in limits or, where it is known no better, in five sigmas: over 1, it is not there.
[[nodiscard]] double TimesTooFar(const Placed& placed, const Se3& place, const PlaceLimit& limit = kExactly);
// From where the drawing has it.
[[nodiscard]] bool IsFar(const Placed& placed, const PlaceLimit& limit = kExactly);

// "621 mm and 3 deg": from where the drawing has it, without what is open.
[[nodiscard]] std::string OffNominalText(const Placed& placed, const PlaceLimit& limit = kExactly);
// ", by what was measured of it"; empty: all of it was.
[[nodiscard]] std::string ByMeasuredText(const Placed& placed);

// Of the newest drawing that has a sensor; the reference is there too, where it is. Empty: nothing is drawn.
[[nodiscard]] std::vector<Placed> PlacedSensors(const GraphSolution& solution, const SessionHeaders& headers,
                                                const SensorId& reference);
// Takes failures of two lidars, as these are matched from where the drawing has them.
[[nodiscard]] std::vector<EdgeId> TakeMatchedFromDrawing(CauseSearch& search, const std::set<SensorId>& misplaced);
// That causes so far say are not where the drawing has them.
[[nodiscard]] std::set<SensorId> MisplacedBy(const std::vector<RootCause>& causes);

}  // namespace rigcal::fleet
