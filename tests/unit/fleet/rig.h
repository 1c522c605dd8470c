// Robots for verdicts: edges and solutions made by hand.
#pragma once

#include <string>
#include <vector>

#include "server/fleet/assess.h"

namespace rigcal::fleet {

inline Edge MakeEdge(char letter, const std::string& a, const std::string& b, int dof = 0) {
  Edge edge;
  edge.id = EdgeId(std::string(64, letter));
  edge.frame_a = SensorId(a), edge.frame_b = SensorId(b);
  edge.uncertainty = FromInformation(1e6 * Matrix6d::Identity(), UncertaintySource::kGiven, dof);
  edge.state = EdgeState::kGood;
  return edge;
}

inline Edge FailedEdge(char letter, const std::string& a, const std::string& b) {
  Edge edge = MakeEdge(letter, a, b);
  edge.state = EdgeState::kFailed;
  edge.diagnoses.push_back({"too_few_captures", "3 captures show the board", "Take at least 10 captures."});
  return edge;
}

inline EdgeResidual ResidualOf(const Edge& edge, double off_m) {
  EdgeResidual residual;
  residual.edge = edge.id;
  residual.in_solution = true;
  residual.e(tangent::kY) = off_m;
  residual.weighted = residual.e.dot(edge.uncertainty.Omega * residual.e);
  return residual;
}

inline SensorPose PoseOf(const std::string& name, bool known = true, double variance = 1e-6) {
  SensorPose pose;
  pose.sensor = SensorId(name);
  pose.known = known;
  if (known) pose.covariance = variance * Matrix6d::Identity();
  return pose;
}

// A triangle in which all is well.
struct Rig {
  std::vector<Edge> edges = {MakeEdge('a', "left", "right"), MakeEdge('b', "right", "top"),
                             MakeEdge('c', "left", "top")};
  GraphSolution solution;
  Rig() {
    solution.converged = true;
    solution.dof = 6;
    solution.poses = {PoseOf("left", true, 0.0), PoseOf("right"), PoseOf("top")};
    for (const Edge& edge : edges) solution.residuals.push_back(ResidualOf(edge, 0.0005));
  }
  [[nodiscard]] Verdict Judge() const { return Assess(edges, solution); }
};

}  // namespace rigcal::fleet
