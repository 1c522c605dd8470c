#include "tests/bench/rig/second_tracker.h"

#include "client/sim/rig/random.h"

namespace rigcal {

sim::Rig WithMast(sim::Rig rig) {
  const SensorId body("body");
  sim::RigSensor mast = rig.SensorOf(body);
  mast.id = kMast;
  mast.T_body_sensor = mast.T_body_sensor * Se3::Exp((Vector6d() << 0.3, -0.1, 0.4, 0.1, -0.2, 0.7).finished());
  mast.tracker = {5e-4, 5e-4};
  rig.sensors.push_back(mast);
  const std::vector<SensorPair> skipped = rig.skip_pairs;
  for (const SensorPair& pair : skipped)
    if (pair.a == body || pair.b == body)
      rig.skip_pairs.push_back({pair.a == body ? kMast : pair.a, pair.b == body ? kMast : pair.b});
  return rig;
}

void DrawWorldOfMast(const OtherWorld& world, sim::Experiment& experiment) {
  sim::Random random(sim::KeyOf(experiment.options.seed, "world of the mast"));
  Vector6d other, step, drift;
  other << 3 * random.Normals<3>(), 0.05 * random.Normal(), 0.05 * random.Normal(), random.Uniform(-M_PI, M_PI);
  step << world.moved.m * random.Normals<3>().normalized(), world.moved.rad * random.Normals<3>().normalized();
  std::vector<Se3> T_told_world;
  Se3 now = Se3::Exp(other);
  for (std::size_t k = 0; k < experiment.captures.size(); ++k) {
    if (k == experiment.captures.size() / 2) now = now * Se3::Exp(step);
    drift << world.drift.m * random.Normals<3>(), world.drift.rad * random.Normals<3>();
    now = (now * Se3::Exp(drift)).Normalized();
    T_told_world.push_back(now);
  }
  experiment.T_told_world[kMast] = T_told_world;
}

}  // namespace rigcal
