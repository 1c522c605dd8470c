#include "client/sim/visit/mounts.h"

#include <algorithm>
#include <cmath>

#include "client/sim/visit/disturb.h"

namespace rigcal::sim {
namespace {

SensorId NamedOrDrawn(const Rig& rig, const std::optional<SensorId>& named, Random& random) {
  const double u = random.Uniform();
  return named.value_or(rig.sensors[static_cast<std::size_t>(u * static_cast<double>(rig.sensors.size()))].id);
}

std::vector<Se3>& OffsetsOf(const SensorId& sensor, Experiment& experiment) {
  std::vector<Se3>& offsets = experiment.T_rest_sensor[sensor];
  offsets.resize(experiment.captures.size());
  return offsets;
}

// The sensor that is displaced, how far at most, and its offsets to be filled in.
struct Displaced {
  Vector6d by;
  std::vector<Se3>& offsets;
};
Displaced DrawDisplaced(const char* purpose, const Displacement& by, const std::optional<SensorId>& named,
                        Experiment& experiment) {
  Random random(KeyOf(experiment.options.seed, purpose));
  experiment.displaced = NamedOrDrawn(experiment.rig, named, random);
  return {AnyWay(by, random), OffsetsOf(*experiment.displaced, experiment)};
}

void Displace(Experiment& experiment) {
  if (!experiment.options.disturb.excursion) return;
  const Excursion& excursion = *experiment.options.disturb.excursion;
  const auto [by, offsets] = DrawDisplaced("excursion", excursion.by, excursion.sensor, experiment);
  const std::size_t until = std::min(offsets.size(), experiment.IndexAt(excursion.until_ratio));
  for (std::size_t k = experiment.IndexAt(excursion.from_ratio); k < until; ++k) offsets[k] = Se3::Exp(by);
}

void GiveWay(Experiment& experiment) {
  if (!experiment.options.disturb.creep) return;
  const Creep& creep = *experiment.options.disturb.creep;
  const auto [by, offsets] = DrawDisplaced("creep", creep.by, creep.sensor, experiment);
  const double steps = std::max(1.0, static_cast<double>(offsets.size()) - 1);
  for (std::size_t k = 0; k < offsets.size(); ++k) offsets[k] = Se3::Exp(by * (static_cast<double>(k) / steps));
}

void Rattle(Experiment& experiment) {
  const Displacement& sigma = experiment.options.disturb.rattle;
  if (sigma.m == 0 && sigma.rad == 0) return;
  for (const RigSensor& sensor : experiment.rig.sensors) {
    Random random(KeyOf(experiment.options.seed, "rattle", sensor.id.str()));
    for (Se3& offset : OffsetsOf(sensor.id, experiment)) offset = offset * Se3::Exp(ScatterOf(sigma, random));
  }
}

// A random walk: what stands before each true pose.
std::vector<Se3> DriftOf(const Displacement& sigma, std::size_t captures, std::uint64_t key) {
  if (sigma.m == 0 && sigma.rad == 0) return {};
  Random random(key);
  std::vector<Se3> drift(captures);
  for (std::size_t k = 1; k < captures; ++k)
    drift[k] = (drift[k - 1] * Se3::Exp(ScatterOf(sigma, random))).Normalized();
  return drift;
}

Status CheckSensor(const Rig& rig, const std::optional<SensorId>& named) {
  const auto is_it = [&](const RigSensor& sensor) { return sensor.id == *named; };
  if (!named || std::any_of(rig.sensors.begin(), rig.sensors.end(), is_it)) return {};
  return Fail(ErrorCode::kInvalidInput,
              "sensor " + named->str() + " cannot be displaced: the rig has none of this name",
              "Name one of the rig's sensors.");
}

Status CheckSize(const char* option, const Displacement& by) {
  if (by.m >= 0 && by.m <= 1 && by.rad >= 0 && by.rad <= M_PI) return {};
  return Fail(ErrorCode::kInvalidInput, std::string(option) + " is out of range",
              "Give 0 to 1 m and 0 to 180 degrees.");
}

}  // namespace

Status CheckMounts(const Rig& rig, const Disturbances& disturb) {
  if (const auto& excursion = disturb.excursion) {
    RIGCAL_TRY(CheckSensor(rig, excursion->sensor));
    RIGCAL_TRY(CheckSize("excursion", excursion->by));
    if (!(excursion->from_ratio > 0 && excursion->from_ratio < excursion->until_ratio && excursion->until_ratio <= 1))
      return Fail(ErrorCode::kInvalidInput, "excursion is out of range",
                  "Give two ratios between 0 and 1, the smaller one first.");
  }
  if (const auto& creep = disturb.creep) {
    RIGCAL_TRY(CheckSensor(rig, creep->sensor));
    RIGCAL_TRY(CheckSize("creep", creep->by));
  }
  RIGCAL_TRY(CheckSize("rattle", disturb.rattle));
  return CheckSize("pose-drift", disturb.pose_drift);
}

void LoosenMounts(Experiment& experiment) {
  Displace(experiment);
  GiveWay(experiment);
  Rattle(experiment);
  for (const RigSensor& sensor : experiment.rig.sensors)
    if (sensor.kind == SensorKind::kTracker)
      experiment.T_told_world[sensor.id] = DriftOf(experiment.options.disturb.pose_drift, experiment.captures.size(),
                                                   KeyOf(experiment.options.seed, "drift", sensor.id.str()));
}

}  // namespace rigcal::sim
