// An edge whose numbers all differ, so that two that are exchanged are seen.
#pragma once

#include "idl/convert.h"

namespace rigcal::wire {

inline Edge SampleEdge(double shift_m = 0.0) {
  Edge edge;
  edge.robot = RobotId("mapper-01");
  edge.frame_a = SensorId("left");
  edge.frame_b = SensorId("right");
  edge.T_a_b = Se3{{1.25 + shift_m, -2.5, 3.75}, {0.5, 0.1, -0.7, 0.5}};
  edge.T_a_b.q = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.5);
  Matrix6d Omega = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    Omega(i, i) = 100.0 + i;
    for (int k = 0; k < i; ++k) Omega(i, k) = Omega(k, i) = 0.5 * i + 0.125 * k;
  }
  edge.uncertainty = FromInformation(Omega, UncertaintySource::kJackknife, 11);
  for (int block = 0; block < 3; ++block) {
    BlockVector& to = edge.uncertainty.blocks.emplace_back();
    to.block_id = "capture-" + std::to_string(block);
    for (int i = 0; i < 6; ++i) to.d[i] = 10.0 * block + i + 0.5;
  }
  Matrix6d part = Matrix6d::Zero();
  part.diagonal() << 1, 2, 3, 4, 5, 6;
  edge.uncertainty.contributions.push_back({"board size", 1e-6 * part});
  edge.uncertainty.jackknife_ratio = 0.1 + 0.2;
  edge.method = "given";
  edge.measured_at = Stamp{1'700'000'000'000'000'001};
  edge.state = EdgeState::kGood;
  return edge;
}

// A batch of edges with their ids set.
inline std::vector<BatchItem> SampleBatch(std::vector<Edge> edges) {
  AssignPushedIds(edges);
  const BatchId batch = BatchIdOf(edges.front().robot, edges);
  std::vector<BatchItem> items;
  for (std::uint32_t i = 0; i < edges.size(); ++i)
    items.push_back({batch, i, static_cast<std::uint32_t>(edges.size()), edges[i]});
  return items;
}

}  // namespace rigcal::wire
