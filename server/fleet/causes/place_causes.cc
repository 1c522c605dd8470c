// Sensors that are not where the drawing has them, each by itself.
#include <algorithm>

#include "server/fleet/causes/cause_findings.h"
#include "server/fleet/causes/placed_sensors.h"

namespace rigcal::fleet {
namespace {

// Sensors that are all elsewhere tell of the one that they are measured from.
constexpr std::size_t kReferenceSuspected = 3;

// But those that are accounted for; the worst first. `others`: how many there are beside the reference.
struct FarSensors {
  std::vector<Placed> far;
  std::size_t others = 0;
};

FarSensors FarFrom(const GraphSolution& solution, const SessionHeaders& headers, const SensorId& reference,
                   const std::set<SensorId>& accounted_for, const PlaceLimit& limit) {
  FarSensors sensors{PlacedSensors(solution, headers, reference)};
  std::erase_if(sensors.far, [&](const Placed& one) { return one.sensor == reference; });
  sensors.others = sensors.far.size();
  std::erase_if(sensors.far,
                [&](const Placed& one) { return accounted_for.contains(one.sensor) || !IsFar(one, limit); });
  std::stable_sort(sensors.far.begin(), sensors.far.end(),
                   [](const Placed& x, const Placed& y) { return TimesTooFar(x, x.drawn) > TimesTooFar(y, y.drawn); });
  return sensors;
}

Finding Elsewhere(const std::vector<Placed>& far, const SensorId& reference, bool all, const PlaceLimit& limit) {
  std::vector<SensorId> sensors;
  for (const Placed& one : far) sensors.push_back(one.sensor);
  const std::string names = List(sensors), worst = far.front().sensor.str(), off = OffNominalText(far.front(), limit),
                    by_measured = ByMeasuredText(far.front());
  DecidingFigure figure{worst + " from its nominal (CAD) pose", off, ""};
  if (far.size() == 1)
    return {names + " sits " + off + " from its nominal (CAD) pose" + by_measured,
            "Check the name and the mount of " + names + ", or correct its T_ref_nominal in session.yaml", sensors,
            std::move(figure)};
  const std::string why =
      names + " do not sit at their nominal (CAD) poses: " + worst + " is off by " + off + by_measured;
  if (!all)
    return {why, "Check their names and their mounts, or correct their T_ref_nominal in session.yaml", sensors,
            std::move(figure)};
  return {why,
          "Check the name and the mount of " + reference.str() + ", from which all are measured",
          {reference},
          std::move(figure)};
}

}  // namespace

void FindFarFromNominal(CauseSearch& search) {
  const SensorPose* reference = ReferenceOf(search.solution);
  const std::set<SensorId> told = MisplacedBy(search.causes);
  if (reference == nullptr || told.contains(reference->sensor)) return;
  const auto [far, others] = FarFrom(search.solution, search.headers, reference->sensor, told, kRoughly);
  if (far.empty()) return;
  RootCause cause;
  cause.kind = CauseKind::kFarFromNominal;
  for (const Placed& one : far) cause.sensors.push_back(one.sensor);
  cause.edges = TakeMatchedFromDrawing(search, {cause.sensors.begin(), cause.sensors.end()});
  cause.said = Elsewhere(far, reference->sensor, far.size() == others && others >= kReferenceSuspected, kRoughly);
  search.causes.push_back(std::move(cause));
}

std::optional<Finding> FindOffNominal(const std::vector<Edge>& edges, const GraphSolution& solution,
                                      const SessionHeaders& headers, const std::vector<RootCause>& causes,
                                      const std::set<SensorId>& around) {
  const SensorPose* reference = ReferenceOf(solution);
  const std::set<SensorId> told = MisplacedBy(causes);
  if (reference == nullptr || told.contains(reference->sensor)) return std::nullopt;
  auto [off, others] = FarFrom(solution, WithoutPast(headers, edges), reference->sensor, told, kExactly);
  std::erase_if(off, [&](const Placed& one) { return !around.contains(one.sensor); });
  if (off.empty()) return std::nullopt;
  return Elsewhere(off, reference->sensor, false, kExactly);
}

}  // namespace rigcal::fleet
