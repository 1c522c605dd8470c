#include "client/sim/rig/rig_yaml.h"
#include "tests/paper/global_experiment.h"

namespace rigcal::paper {
namespace {

// Two lidars are not among them: their search tries everything before it refuses, which takes as long as all the rest.
std::vector<SensorPair> OnePairPerMethod() {
  std::vector<SensorPair> pairs;
  for (const auto& [a, b] : {std::pair("left_front", "left_back"), std::pair("left_front", "up_left"),
                             std::pair("left_front", "body"), std::pair("left_front", "lidar_vertical")})
    pairs.push_back({SensorId(a), SensorId(b)});
  return pairs;
}

NoisyPair Told(const sim::Experiment& experiment, const Edge& edge) {
  NoisyPair pair{edge.frame_a, edge.frame_b, edge.method, {}, 0, 0};
  if (edge.state == EdgeState::kFailed) {
    pair.refusal = edge.diagnoses.front().what;
    return pair;
  }
  const Vector6d e = (TruthOf(experiment, edge.frame_b, edge.frame_a) * edge.T_a_b).Log();
  pair.error_m = e.head<3>().norm();
  pair.error_rad = e.tail<3>().norm();
  return pair;
}

}  // namespace

Result<std::vector<NoisyPair>> TryNoisySensors(const sim::Experiment& like, double noise_factor, VisitOptions how) {
  RIGCAL_ASSIGN(const sim::Rig rig, sim::LoadRig(like.rig.name));
  sim::Options options = like.options;
  options.noise_factor = noise_factor;
  how.only = OnePairPerMethod();
  RIGCAL_ASSIGN(const Visit visit, MakeVisit(rig, options, how));
  std::vector<NoisyPair> pairs;
  for (const Edge& edge : visit.edges) pairs.push_back(Told(visit.experiment, edge));
  return pairs;
}

}  // namespace rigcal::paper
