#include "tests/paper/paths.h"

namespace rigcal::paper {
namespace {

std::optional<Step> FindStep(const std::vector<Edge>& edges, const SensorId& a, const SensorId& b,
                             const std::string* method) {
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const Edge& edge = edges[k];
    if (edge.state != EdgeState::kGood || (method != nullptr && edge.method != *method)) continue;
    if (edge.frame_a == a && edge.frame_b == b) return Step{k, false};
    if (edge.frame_a == b && edge.frame_b == a) return Step{k, true};
  }
  return std::nullopt;
}

Se3 PoseOf(const std::vector<Edge>& edges, const Step& step) {
  return step.reversed ? edges[step.edge].T_a_b.Inverse() : edges[step.edge].T_a_b;
}

}  // namespace

std::optional<Path> FindPath(const std::vector<Edge>& edges, const std::vector<SensorId>& sensors,
                             const std::vector<std::string>& methods) {
  Path path;
  for (std::size_t i = 1; i < sensors.size(); ++i) {
    const auto step = FindStep(edges, sensors[i - 1], sensors[i], methods.empty() ? nullptr : &methods[i - 1]);
    if (!step) return std::nullopt;
    path.push_back(*step);
  }
  return path;
}

Se3 Compose(const std::vector<Edge>& edges, const Path& path) {
  Se3 T;
  for (const Step& step : path) T = T * PoseOf(edges, step);
  return T.Normalized();
}

Eigen::MatrixXd ErrorMap(const std::vector<Edge>& edges, const Path& path) {
  Eigen::MatrixXd map = Eigen::MatrixXd::Zero(6, 6 * static_cast<Eigen::Index>(edges.size()));
  Se3 T_rest;  // from the step's end to the path's
  for (auto step = path.rbegin(); step != path.rend(); ++step) {
    Matrix6d own = Adjoint(T_rest.Inverse());
    if (step->reversed) own = -own * Adjoint(edges[step->edge].T_a_b);
    map.middleCols<6>(6 * static_cast<Eigen::Index>(step->edge)) += own;
    T_rest = PoseOf(edges, *step) * T_rest;
  }
  return map;
}

}  // namespace rigcal::paper
