#include "tests/paper/method_experiment.h"

#include <algorithm>
#include <cmath>

#include "tests/paper/paths.h"

namespace rigcal::paper {
namespace {

using Eigen::MatrixXd;

// Two ways from a to b: sensors on the way, and the method of each step.
struct Leg {
  std::vector<const char*> through;
  std::vector<std::string> methods;
};
struct Family {
  const char *first, *second;
  std::vector<std::pair<const char*, const char*>> pairs;
  Leg leg_first, leg_second;
};

const std::vector<std::pair<const char*, const char*>> kStereoPairs = {
    {"front_left", "front_right"}, {"left_front", "left_back"}, {"right_front", "right_back"}, {"up_left", "up_right"}};

std::vector<Family> Families() {
  return {{"one board seen by both", "how they move", kStereoPairs, {{}, {"stereo"}}, {{}, {"non_overlapping"}}},
          {"one board seen by both",
           "each with the tracker",
           kStereoPairs,
           {{}, {"stereo"}},
           {{"body"}, {"tracker_camera", "tracker_camera"}}},
          {"lidar and camera",
           "camera, other lidar, NDT",
           {{"left_front", "lidar_vertical"},
            {"left_back", "lidar_vertical"},
            {"right_front", "lidar_vertical"},
            {"right_back", "lidar_vertical"}},
           {{}, {"lidar_camera"}},
           {{"lidar_horizontal"}, {"lidar_camera", "lidar_lidar"}}}};
}

std::optional<Path> PathOf(const std::vector<Edge>& edges, const MethodPair& pair, const Leg& leg) {
  std::vector<SensorId> sensors = {pair.a};
  for (const char* name : leg.through) sensors.emplace_back(name);
  sensors.push_back(pair.b);
  return FindPath(edges, sensors, leg.methods);
}

Vector6d SigmaOf(const MatrixXd& columns) { return columns.rowwise().norm(); }

// Good edges of a visit, by either method, and how they err together.
struct KnownEdges {
  const sim::Experiment& experiment;
  std::vector<Edge> edges;
  MatrixXd columns;

  explicit KnownEdges(const Visit& visit) : experiment(visit.experiment) {
    for (const auto* list : {&visit.edges, &visit.other_method})
      std::copy_if(list->begin(), list->end(), std::back_inserter(edges),
                   [](const Edge& edge) { return edge.state == EdgeState::kGood; });
    columns = ErrorColumns(edges);
  }
};

void AddSample(const KnownEdges& visit, const Family& family, MethodPair& pair) {
  const auto first = PathOf(visit.edges, pair, family.leg_first), second = PathOf(visit.edges, pair, family.leg_second);
  if (!first || !second) return;
  const Se3 T_first = Compose(visit.edges, *first), T_second = Compose(visit.edges, *second);
  const Se3 T_b_a_true = TruthOf(visit.experiment, pair.b, pair.a);
  const MatrixXd map_first = ErrorMap(visit.edges, *first), map_second = ErrorMap(visit.edges, *second);
  pair.samples.push_back({(T_first.Inverse() * T_second).Log(), SigmaOf((map_second - map_first) * visit.columns),
                          SigmaOf(map_first * visit.columns), SigmaOf(map_second * visit.columns),
                          (T_b_a_true * T_first).Log(), (T_b_a_true * T_second).Log()});
}

void Judge(MethodFamily& family) {
  double within = 0, squares = 0;
  for (const MethodPair& pair : family.pairs)
    for (const MethodSample& sample : pair.samples)
      for (int axis = 0; axis < 6; ++axis) {
        const double sigmas = std::abs(sample.difference[axis]) / sample.sigma_difference[axis];
        within += sigmas <= 3 ? 1 : 0;
        squares += sigmas * sigmas;
        ++family.coordinates;
      }
  const double count = std::max<double>(1, static_cast<double>(family.coordinates));
  family.within_3_sigma_ratio = within / count;
  family.rms_sigmas = std::sqrt(squares / count);
}

}  // namespace

MethodExperiment RunMethodExperiment(const std::vector<Visit>& visits) {
  const std::vector<Family> families = Families();
  MethodExperiment experiment;
  for (const Family& family : families) {
    experiment.families.push_back({family.first, family.second, {}, 0, 0, 0});
    for (const auto& [a, b] : family.pairs) experiment.families.back().pairs.push_back({SensorId(a), SensorId(b), {}});
  }
  for (const Visit& visit : visits) {
    const KnownEdges known(visit);
    for (std::size_t f = 0; f < families.size(); ++f)
      for (MethodPair& pair : experiment.families[f].pairs) AddSample(known, families[f], pair);
  }
  for (MethodFamily& family : experiment.families) Judge(family);
  return experiment;
}

}  // namespace rigcal::paper
