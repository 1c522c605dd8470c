#include "server/fleet/weak_edges.h"

#include <algorithm>
#include <map>
#include <utility>

#include "server/fleet/wording.h"
#include "server/math/covariance.h"
#include "server/model/edges/weak_edge.h"

namespace rigcal::fleet {
namespace {

// What it is off by, along the directions that it sees.
Vector6d OffBy(const Edge& edge, const Se3& T_ref_a, const Se3& T_ref_b) {
  const Matrix6d& Omega = edge.uncertainty.Omega;
  const Vector6d e = (edge.T_a_b.Inverse() * T_ref_a.Inverse() * T_ref_b).Log();
  return Observable(Omega).covariance * Omega * e;
}

const Se3* KnownPose(const GraphSolution& solution, const SensorId& sensor) {
  for (const SensorPose& pose : solution.poses)
    if (pose.sensor == sensor && pose.known) return &pose.T_ref_sensor;
  return nullptr;
}

struct Furthest {
  const Edge* edge = nullptr;
  Vector6d off = Vector6d::Zero();
};

Diagnosis NoteOn(const Furthest& one) {
  return {
      "weak_edge",
      NameOfEdge(*one.edge) + " takes no part: " + WhyWeak(*one.edge) + ", and better pairs hold both; it is " +
          OffText(one.off) + " off from where these have them",
      "Nothing has to be done. It counts once captures show surroundings that both see well, facing three different "
      "ways."};
}

}  // namespace

std::vector<Diagnosis> NotesOnWeakEdges(const std::vector<Edge>& edges, const std::set<EdgeId>& weak,
                                        const GraphSolution& solution) {
  std::map<std::pair<SensorId, SensorId>, Furthest> furthest;
  for (const Edge& edge : edges) {
    if (!weak.contains(edge.id)) continue;
    const Se3 *T_ref_a = KnownPose(solution, edge.frame_a), *T_ref_b = KnownPose(solution, edge.frame_b);
    if (T_ref_a == nullptr || T_ref_b == nullptr) continue;
    const Vector6d off = OffBy(edge, *T_ref_a, *T_ref_b);
    Furthest& one = furthest[std::minmax(edge.frame_a, edge.frame_b)];
    if (one.edge == nullptr || off.norm() > one.off.norm()) one = {&edge, off};
  }
  std::vector<Diagnosis> notes;
  for (const auto& [pair, one] : furthest) notes.push_back(NoteOn(one));
  return notes;
}

std::vector<Edge> WithoutWeakAside(std::vector<Edge> edges, const GraphSolution& solution) {
  std::set<EdgeId> took_part;
  for (const EdgeResidual& residual : solution.residuals) took_part.insert(residual.edge);
  std::erase_if(edges, [&](const Edge& edge) { return !WhyWeak(edge).empty() && !took_part.contains(edge.id); });
  return edges;
}

}  // namespace rigcal::fleet
