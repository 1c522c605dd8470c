// One visit to a virtual robot through the product's estimators, without pictures: noisy corners, plate points, tracker
// poses and whole scans in, finished edges out.
#pragma once

#include <vector>

#include "client/sim/visit/observe.h"
#include "server/model/edges/edge.h"

namespace rigcal::paper {

struct VisitOptions {
  std::size_t lidar_pair_captures = 8;  // whole scans cost most: so many captures enter the edge of two lidars
  int threads = 0;                      // 0: as many as the machine has; the answer does not depend on it
  std::vector<SensorPair> only = {};    // if not empty: no other pairs
};

// What one visit gave. Edges come in the order of PairsToCalibrate().
struct Visit {
  sim::Experiment experiment;
  std::vector<Edge> edges;         // all pairs of the rig; failed ones too
  std::vector<Edge> other_method;  // pairs of cameras before one board, by how they move instead ("non_overlapping")
};

// Deterministic. An error if the rig does not allow the options.
[[nodiscard]] Result<Visit> MakeVisit(const sim::Rig& rig, const sim::Options& options, const VisitOptions& how);

[[nodiscard]] std::vector<Edge> GoodEdges(const Visit& visit);
// T_a_b that is true.
[[nodiscard]] Se3 TruthOf(const sim::Experiment& experiment, const SensorId& a, const SensorId& b);

}  // namespace rigcal::paper
