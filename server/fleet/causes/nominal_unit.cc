// Sensors whose nominal pose has millimetres where metres are meant, others of the same file in metres or not: drawn a
// thousand times as far from the reference as they are, in the same direction.
#include <algorithm>

#include "server/fleet/causes/placed_sensors.h"

namespace rigcal::fleet {
namespace {

// Of how far away a sensor is: what a nominal pose may be off by. Nothing else makes a thousand of that.
constexpr double kMillimetres = 1e-3, kOff = 0.2, kNearest_m = 0.02, kUnitSigmas = 5.0;

// Where it is if millimetres are meant; of what is open, as near to that as it goes.
Eigen::Vector3d MeasuredAt_m(const Placed& placed) {
  return NearestTo(placed, {kMillimetres * placed.drawn.p_m, placed.drawn.q}).p_m;
}

bool IsInMillimetres(const Placed& placed) {
  const Eigen::Vector3d in_metres = kMillimetres * placed.drawn.p_m, measured_m = MeasuredAt_m(placed);
  const double away_m = measured_m.norm();
  return away_m >= kNearest_m && IsFar(placed, kRoughly) &&
         (in_metres - measured_m).norm() <= std::max(kOff * away_m, kUnitSigmas * placed.sigma_m) &&
         away_m > 2 * kUnitSigmas * placed.sigma_m;
}

Finding InMillimetres(const std::vector<Placed>& placed, const SensorId& reference) {
  std::vector<SensorId> sensors;
  for (const Placed& one : placed) sensors.push_back(one.sensor);
  const Placed& first = placed.front();
  const bool one = sensors.size() == 1;
  const std::string names = List(sensors);
  return {std::string("the nominal (CAD) ") + (one ? "pose" : "poses") + " of " + names + (one ? " looks" : " look") +
              " like millimetres: " + first.sensor.str() + " is given " + Number(first.drawn.p_m.norm(), "m") +
              " from " + reference.str() + " and measured " + Number(MeasuredAt_m(first).norm(), "m") + " from it" +
              ByMeasuredText(first),
          "Give T_ref_nominal of " + names + " in session.yaml in metres", sensors};
}

}  // namespace

void FindNominalUnits(CauseSearch& search) {
  const SensorPose* reference = ReferenceOf(search.solution);
  if (reference == nullptr) return;
  std::vector<Placed> placed = PlacedSensors(search.solution, search.headers, reference->sensor);
  std::erase_if(placed, [](const Placed& one) { return !IsInMillimetres(one); });
  if (placed.empty()) return;
  RootCause cause;
  cause.kind = CauseKind::kNominalUnit;
  for (const Placed& one : placed) cause.sensors.push_back(one.sensor);
  cause.edges = TakeMatchedFromDrawing(search, {cause.sensors.begin(), cause.sensors.end()});
  cause.said = InMillimetres(placed, reference->sensor);
  cause.command = kPushAgain;
  search.causes.push_back(std::move(cause));
}

}  // namespace rigcal::fleet
