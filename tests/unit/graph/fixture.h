// What the tests of server/graph share beside random graphs: comparison and real data.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/formats/edges/g2o.h"
#include "tests/unit/graph/random.h"
#include "tests/unit/recordings.h"

namespace rigcal::graph {

inline bool SameBytes(const GraphSolution& a, const GraphSolution& b) {
  if (a.poses.size() != b.poses.size() || a.residuals.size() != b.residuals.size()) return false;
  for (std::size_t k = 0; k < a.poses.size(); ++k) {
    const Se3 &T = a.poses[k].T_ref_sensor, &U = b.poses[k].T_ref_sensor;
    if (a.poses[k].sensor != b.poses[k].sensor || a.poses[k].known != b.poses[k].known) return false;
    if (std::memcmp(T.p_m.data(), U.p_m.data(), 24) != 0 ||
        std::memcmp(T.q.coeffs().data(), U.q.coeffs().data(), 32) != 0)
      return false;
    if (std::memcmp(a.poses[k].covariance.data(), b.poses[k].covariance.data(), 288) != 0) return false;
    const auto &part = a.poses[k].measured_part, &other = b.poses[k].measured_part;
    if (part.has_value() != other.has_value()) return false;
    if (part && (part->T_ref_sensor != other->T_ref_sensor || part->covariance != other->covariance)) return false;
  }
  for (std::size_t k = 0; k < a.residuals.size(); ++k)
    if (a.residuals[k].edge != b.residuals[k].edge ||
        std::memcmp(a.residuals[k].e.data(), b.residuals[k].e.data(), 48) != 0)
      return false;
  return std::memcmp(&a.cost, &b.cost, 8) == 0 && std::memcmp(&a.before.total, &b.before.total, 8) == 0;
}

// Which has to be there.
inline const GraphEdge& EdgeBy(const Graph& graph, const EdgeId& id) {
  return *std::find_if(graph.edges.begin(), graph.edges.end(), [&](const GraphEdge& edge) { return edge.id == id; });
}

inline double Distance(const Se3& T, const Se3& U) { return (T.Inverse() * U).Log().norm(); }

inline Result<formats::G2oFile> ReadData(const std::string& name) {
  const std::ifstream file(Recording(name));
  std::ostringstream text;
  text << file.rdbuf();
  return formats::ReadG2o(text.str(), RobotId("robot"));
}

}  // namespace rigcal::graph
