#include "server/fleet/weak_edges.h"

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

}  // namespace

std::vector<Diagnosis> NotesOnWeakEdges(const std::vector<Edge>& edges, const std::set<EdgeId>& weak,
                                        const GraphSolution& solution) {
  std::vector<Diagnosis> notes;
  for (const Edge& edge : edges) {
    if (!weak.contains(edge.id)) continue;
    const Se3 *T_ref_a = KnownPose(solution, edge.frame_a), *T_ref_b = KnownPose(solution, edge.frame_b);
    if (T_ref_a == nullptr || T_ref_b == nullptr) continue;
    const Vector6d off = OffBy(edge, *T_ref_a, *T_ref_b);
    notes.push_back(
        {"weak_edge",
         NameOfEdge(edge) + " takes no part: " + WhyWeak(edge) + ", and better pairs hold both; it is " + OffText(off) +
             " off from where these have them",
         "Nothing has to be done. It counts once captures show surroundings that both see well, facing three "
         "different ways."});
  }
  return notes;
}

}  // namespace rigcal::fleet
