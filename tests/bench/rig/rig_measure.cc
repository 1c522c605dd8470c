// How near the poses of the virtual MARS Mapper come to the Cramer-Rao bound, without a picture: corners, plate points
// and tracker poses with noise through every estimator and the graph. rig_measure [OPTIONS] SEEDS prints one JSON
// object. --intrinsics exact|calibrated|absent; --first SEED; --edges: every kind of edge against the bound of its two
// sensors alone; --weights-of-bound: the graph with those bounds as weights.
#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>

#include "client/sim/bound.h"
#include "client/sim/rig/rig_yaml.h"
#include "tests/bench/rig/rig_edges.h"

namespace rigcal::sim {
namespace {

struct Settings {
  Options options;
  int first = 1, seeds = 0;
  bool edges = false, lidar_pairs = true, weights_of_bound = false;
};

// Squares of errors, of what the bound allows, and of errors in their own sigmas.
struct Sums {
  double error_m2 = 0, error_rad2 = 0, bound_m2 = 0, bound_rad2 = 0, squares = 0, worst = 0;
  int count = 0;

  void Add(const Vector6d& error, const BoundSigma& bound, const Matrix6d& covariance) {
    error_m2 += error.head<3>().squaredNorm();
    error_rad2 += error.tail<3>().squaredNorm();
    for (std::size_t i = 0; i < 6; ++i) (i < 3 ? bound_m2 : bound_rad2) += std::pow(bound[i].value_or(0.0), 2);
    squares += error.dot(covariance.ldlt().solve(error)) / 6;
    for (int i = 0; i < 6; ++i) worst = std::max(worst, std::abs(error[i]) / std::sqrt(covariance(i, i)));
    ++count;
  }
  void Add(const Sums& other) {
    error_m2 += other.error_m2, error_rad2 += other.error_rad2;
    bound_m2 += other.bound_m2, bound_rad2 += other.bound_rad2;
    squares += other.squares, count += other.count;
    worst = std::max(worst, other.worst);
  }
  void Print(const std::string& name, const char* comma) const {
    std::printf(
        "%s\n\"%s\": {\"count\": %d, \"rms_mm\": %.4f, \"rms_deg\": %.5f, \"bound_mm\": %.4f, \"bound_deg\": %.5f, "
        "\"ratio_translation\": %.3f, \"ratio_rotation\": %.3f, \"mean_square\": %.3f, \"worst_sigmas\": %.2f}",
        comma, name.c_str(), count, 1e3 * std::sqrt(error_m2 / count), 180 / M_PI * std::sqrt(error_rad2 / count),
        1e3 * std::sqrt(bound_m2 / count), 180 / M_PI * std::sqrt(bound_rad2 / count), std::sqrt(error_m2 / bound_m2),
        std::sqrt(error_rad2 / bound_rad2), squares / count, worst);
  }
};
using SumsByName = std::map<std::string, Sums>;

// The same visit to a robot that has these two sensors only.
Experiment PairOnly(Experiment experiment, const SensorId& a, const SensorId& b) {
  std::vector<RigSensor> both;
  for (const RigSensor& sensor : experiment.rig.sensors)
    if (sensor.id == a || sensor.id == b) both.push_back(sensor);
  experiment.rig.sensors = both;
  experiment.rig.reference = a;
  const auto is_seen = [&](const RigBoard& board) {
    return std::any_of(both.begin(), both.end(),
                       [&](const RigSensor& sensor) { return sensor.sees == board.target.id; });
  };
  std::erase_if(experiment.rig.boards, [&](const RigBoard& board) { return !is_seen(board); });
  std::erase_if(experiment.rig.skip_pairs, [&](const SensorPair& pair) {
    return !((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a));
  });
  return experiment;
}

// Every edge weighted as an estimator would that knows its own noise and makes the best of its two sensors.
std::vector<Edge> Reweighted(const Experiment& experiment, std::vector<Edge> edges) {
  for (Edge& edge : edges) {
    if (edge.method == "lidar_lidar") continue;
    const auto covariance = CramerRaoCovariance(PairOnly(experiment, edge.frame_a, edge.frame_b), edge.frame_b);
    if (covariance) edge.uncertainty.Omega = Symmetrized(covariance->inverse());
  }
  return edges;
}

void AddEdges(const Experiment& experiment, const std::vector<Edge>& edges, SumsByName& sums) {
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || edge.method == "lidar_lidar") continue;
    const auto bound = CramerRaoBound(PairOnly(experiment, edge.frame_a, edge.frame_b));
    sums["edge_" + edge.method].Add(EdgeError(experiment, edge), bound.at(edge.frame_b), edge.uncertainty.covariance);
  }
}

void AddSensors(const Experiment& experiment, const SolvedRig& solved, SumsByName& sums) {
  const auto bound = CramerRaoBound(experiment);
  for (const SensorPose& pose : solved.solution.poses) {
    if (!pose.known || pose.sensor == solved.graph.reference) continue;
    const Vector6d error = (pose.T_ref_sensor.Inverse() * experiment.T_ref_sensor(pose.sensor)).Log();
    sums["sensor_" + pose.sensor.str()].Add(error, bound.at(pose.sensor), pose.covariance);
  }
}

SumsByName Grouped(const Experiment& experiment, const SumsByName& sums) {
  SumsByName groups;
  for (const RigSensor& sensor : experiment.rig.sensors)
    if (const auto found = sums.find("sensor_" + sensor.id.str()); found != sums.end()) {
      groups[NameOf(sensor.kind) + "s"].Add(found->second);
      if (sensor.kind != SensorKind::kTracker) groups["all_but_tracker"].Add(found->second);
    }
  return groups;
}

int Measure(const Settings& settings) {
  const auto rig = LoadRig("mars-mapper");
  if (!rig) return std::cerr << Sentence(rig.error()) << "\n", 1;
  SumsByName sums;
  int good = 1 << 30;
  double edges_s = 0;
  Experiment last;
  for (int i = 0; i < settings.seeds; ++i) {
    Options options = settings.options;
    options.seed = static_cast<std::uint64_t>(settings.first + i);
    auto experiment = Prepare(*rig, options);
    if (!experiment) return std::cerr << Sentence(experiment.error()) << "\n", 1;
    const Observations seen = Observe(*experiment);
    const auto begin = std::chrono::steady_clock::now();
    const std::vector<Edge> edges = RigEdges(*experiment, seen, {settings.lidar_pairs});
    edges_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    good = std::min(good, static_cast<int>(std::count_if(edges.begin(), edges.end(), [](const Edge& edge) {
                      return edge.state == EdgeState::kGood;
                    })));
    AddSensors(*experiment, SolveRig(*experiment, settings.weights_of_bound ? Reweighted(*experiment, edges) : edges),
               sums);
    if (settings.edges) AddEdges(*experiment, edges, sums);
    last = std::move(*experiment);
  }
  std::printf("{\"seeds\": %d, \"good_edges\": %d, \"edges_s\": %.2f", settings.seeds, good, edges_s / settings.seeds);
  for (const auto& [name, sum] : Grouped(last, sums)) sum.Print(name, ",");
  for (const auto& [name, sum] : sums) sum.Print(name, ",");
  std::printf("}\n");
  return 0;
}

std::optional<Settings> Parse(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i], next = i + 1 < argc ? argv[i + 1] : "";
    if (word == "--edges") {
      settings.edges = true;
    } else if (word == "--no-lidar-pair") {
      settings.lidar_pairs = false;
    } else if (word == "--weights-of-bound") {
      settings.weights_of_bound = true;
    } else if (word == "--first") {
      settings.first = std::atoi(argv[++i]);
    } else if (word == "--intrinsics") {
      settings.options.intrinsics = next == "exact"    ? IntrinsicsKind::kExact
                                    : next == "absent" ? IntrinsicsKind::kAbsent
                                                       : IntrinsicsKind::kCalibrated;
      ++i;
    } else {
      settings.seeds = std::atoi(word.c_str());
    }
  }
  return settings.seeds > 0 ? std::optional(settings) : std::nullopt;
}

}  // namespace
}  // namespace rigcal::sim

int main(int argc, char** argv) {
  const auto settings = rigcal::sim::Parse(argc, argv);
  if (!settings) {
    std::fprintf(
        stderr,
        "usage: rig_measure [--intrinsics exact|calibrated|absent] [--first SEED] [--edges] [--weights-of-bound] "
        "[--no-lidar-pair] SEEDS\n");
    return 2;
  }
  return rigcal::sim::Measure(*settings);
}
