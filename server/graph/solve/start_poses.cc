#include "server/graph/solve/start_poses.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace rigcal::graph {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;

// Constraints from the most to the least certain. 1/2 log det C = -1/2 log det Omega.
std::vector<std::size_t> ByCertainty(const Problem& problem) {
  std::vector<std::tuple<int, double, std::size_t>> keys(problem.constraints.size());
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const Constraint& c = problem.constraints[k];
    keys[k] = {-c.rank, c.rank == 6 ? -c.log_det_Omega : 0.0, k};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::size_t> order(keys.size());
  for (std::size_t k = 0; k < keys.size(); ++k) order[k] = std::get<2>(keys[k]);
  return order;
}

// The tree's edges at each vertex, as lists through arrays: entry 2 k is constraint k at its i, 2 k + 1 at its j.
struct TreeEdges {
  static constexpr std::size_t kEnd = static_cast<std::size_t>(-1);
  std::vector<std::size_t> first, next;  // by vertex, by entry

  TreeEdges(std::size_t vertices, std::size_t constraints) : first(vertices, kEnd), next(2 * constraints, kEnd) {}
  void Add(int vertex, std::size_t entry) {
    next[entry] = std::exchange(first[static_cast<std::size_t>(vertex)], entry);
  }
};

// Placed vertices count as one.
TreeEdges FindTree(const Problem& problem, const std::vector<bool>& placed) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  UnionFind sets(count);
  for (std::size_t v = 1; v < count; ++v)
    if (placed[v]) sets.Join(0, static_cast<int>(v));
  TreeEdges tree(count, problem.constraints.size());
  for (const std::size_t k : ByCertainty(problem)) {
    const Constraint& c = problem.constraints[k];
    if (!sets.Join(c.i, c.j)) continue;
    tree.Add(c.i, 2 * k);
    tree.Add(c.j, 2 * k + 1);
  }
  return tree;
}

// The tree, growing from the vertices that are placed already (`placed[v]`; vertex 0 always is). Their poses stay.
Poses GrowTree(const Problem& problem, Poses T_ref, std::vector<bool> placed) {
  placed[0] = true;
  const TreeEdges tree = FindTree(problem, placed);
  std::vector<std::size_t> queue;
  queue.reserve(placed.size());
  for (std::size_t v = 0; v < placed.size(); ++v)
    if (placed[v]) queue.push_back(v);
  for (std::size_t at = 0; at < queue.size(); ++at) {
    const std::size_t v = queue[at];
    for (std::size_t entry = tree.first[v]; entry != TreeEdges::kEnd; entry = tree.next[entry]) {
      const Constraint& c = problem.constraints[entry / 2];
      const bool forward = entry % 2 == 0;
      const auto other = static_cast<std::size_t>(forward ? c.j : c.i);
      if (placed[other]) continue;
      T_ref[other] = (T_ref[v] * (forward ? c.T_i_j : c.T_j_i)).Normalized();
      placed[other] = true;
      queue.push_back(other);
    }
  }
  return T_ref;
}

// Isotropic weight of a 3x3 information block: the harmonic mean of its eigenvalues; next to nothing for an edge with
// an unobservable direction, which only must not leave a vertex without any equation.
double WeightOf(const Constraint& constraint, int start) {
  const Matrix3d block = constraint.Omega.block<3, 3>(start, start);
  constexpr double kDeficient = 1e-6;
  if (constraint.rank < 6) return kDeficient * block.trace() / 3;
  return 3.0 / block.inverse().trace();
}

std::vector<double> Weights(const Problem& problem, int start) {
  std::vector<double> weights;
  weights.reserve(problem.constraints.size());
  for (const Constraint& constraint : problem.constraints) weights.push_back(WeightOf(constraint, start));
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (double& weight : weights) weight = largest > 0.0 ? std::max(weight / largest, 1e-12) : 1.0;
  return weights;
}

// min sum w |R_j^T - R_ij^T R_i^T|^2: the unknowns are the transposed rotations, stacked; R_reference = I.
struct RotationSystem {
  BlockMatrix<3> matrix;
  MatrixXd rhs;
};

RotationSystem MakeRotationSystem(const Problem& problem) {
  RotationSystem system;
  system.matrix.SetZero(problem.pattern);
  system.rhs = MatrixXd::Zero(3 * problem.free_count(), 3);
  const std::vector<double> weights = Weights(problem, tangent::kRotation);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const Constraint& c = problem.constraints[k];
    const Matrix3d R_i_j = weights[k] * c.T_i_j.R();
    for (const int v : {c.i, c.j})
      if (v > 0) system.matrix.diagonal[static_cast<std::size_t>(v) - 1].diagonal().array() += weights[k];
    if (c.slot >= 0) {
      Matrix3d& block = system.matrix.off_diagonal[static_cast<std::size_t>(c.slot)];
      if (c.i > c.j)
        block -= R_i_j;
      else
        block -= R_i_j.transpose();
    } else if (c.i == 0) {
      system.rhs.middleRows<3>(3 * (c.j - 1)) += R_i_j.transpose();
    } else {
      system.rhs.middleRows<3>(3 * (c.i - 1)) += R_i_j;
    }
  }
  return system;
}

bool SolveRotations(const Problem& problem, Poses& T_ref) {
  RotationSystem system = MakeRotationSystem(problem);
  const auto cholesky = MakeCholesky<3>(problem.pattern);
  if (cholesky == nullptr || !cholesky->Factor(system.matrix, 0.0)) return false;
  cholesky->SolveInPlace(system.rhs);
  if (!system.rhs.allFinite()) return false;
  for (int v = 1; v < problem.vertex_count; ++v) {
    const Matrix3d transposed = system.rhs.middleRows<3>(3 * (v - 1));
    T_ref[static_cast<std::size_t>(v)].q = Eigen::Quaterniond(NearestRotation(transposed.transpose()));
  }
  return true;
}

// min sum w |p_j - p_i - R_i p_ij|^2.
bool SolveTranslations(const Problem& problem, Poses& T_ref) {
  BlockMatrix<1> laplacian;
  laplacian.SetZero(problem.pattern);
  MatrixXd p_m = MatrixXd::Zero(problem.free_count(), 3);
  const std::vector<double> weights = Weights(problem, tangent::kTranslation);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const Constraint& c = problem.constraints[k];
    const Eigen::Vector3d pull = weights[k] * (T_ref[static_cast<std::size_t>(c.i)].q * c.T_i_j.p_m);
    if (c.slot >= 0) laplacian.off_diagonal[static_cast<std::size_t>(c.slot)](0) -= weights[k];
    for (const auto& [v, sign] : {std::pair(c.i, -1.0), std::pair(c.j, 1.0)}) {
      if (v == 0) continue;
      laplacian.diagonal[static_cast<std::size_t>(v) - 1](0) += weights[k];
      p_m.row(v - 1) += sign * pull.transpose();
    }
  }
  const auto cholesky = MakeCholesky<1>(problem.pattern);
  if (cholesky == nullptr || !cholesky->Factor(laplacian, 0.0)) return false;
  cholesky->SolveInPlace(p_m);
  for (int v = 1; v < problem.vertex_count; ++v) T_ref[static_cast<std::size_t>(v)].p_m = p_m.row(v - 1);
  return p_m.allFinite();
}

}  // namespace

Poses SpanningTreePoses(const Problem& problem) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  return GrowTree(problem, Poses(count), std::vector<bool>(count, false));
}

std::optional<Poses> ChordalPoses(const Problem& problem) {
  Poses T_ref(static_cast<std::size_t>(problem.vertex_count));
  if (problem.free_count() == 0) return T_ref;
  if (!SolveRotations(problem, T_ref) || !SolveTranslations(problem, T_ref)) return std::nullopt;
  for (Se3& T : T_ref) T = T.Normalized();
  return T_ref;
}

Poses SolvedPoses(const Graph& graph, const Problem& problem, const GraphSolution& solution) {
  std::map<SensorId, const Se3*> solved;
  for (const SensorPose& pose : solution.poses)
    if (pose.Placed() != nullptr) solved.emplace(pose.sensor, pose.Placed());
  Poses T_ref(static_cast<std::size_t>(problem.vertex_count));
  std::vector<bool> placed(T_ref.size(), false);
  for (std::size_t v = 0; v < T_ref.size(); ++v) {
    const auto found = solved.find(graph.sensors[problem.sensor_of_vertex[v]]);
    placed[v] = found != solved.end();
    if (placed[v]) T_ref[v] = *found->second;
  }
  return T_ref.empty() ? T_ref : GrowTree(problem, std::move(T_ref), std::move(placed));
}

}  // namespace rigcal::graph
