#include "server/graph/live/live_state.h"

#include <algorithm>

namespace rigcal::graph {
namespace {

constexpr double kTurnMax_rad = 0.5;  // an edge that disagrees by more may lead to another basin: the batch decides

// Of the off-diagonal block of two vertices, which is made if it is new; -1 if one is the reference.
int SlotOf(int i, int j, LiveState& state) {
  const int row = std::max(i, j) - 1, col = std::min(i, j) - 1;
  if (col < 0) return -1;
  const auto [at, is_new] = state.slot_of_pair.try_emplace((static_cast<std::int64_t>(row) << 32) + col,
                                                           static_cast<int>(state.problem.pattern.off_diagonal.size()));
  if (is_new) {
    state.problem.pattern.off_diagonal.push_back({row, col});
    state.equations.H.off_diagonal.push_back(Matrix6d::Zero());
  }
  return at->second;
}

// All vertices that edges in use reach from the reference; false if the solution has no pose for one.
bool AddVertices(const Graph& graph, const GraphSolution& solution, LiveState& state) {
  std::unordered_map<std::string, const SensorPose*> known;
  for (const SensorPose& pose : solution.poses)
    if (pose.known) known.emplace(pose.sensor.str(), &pose);
  if (known.contains(graph.reference.str())) AddVertex(graph.reference, Se3(), 0, state);
  for (int before = 0; before != state.problem.vertex_count;) {
    before = state.problem.vertex_count;
    for (const GraphEdge& edge : graph.edges) {
      const int a = state.vertices.Of(edge.frame_a), b = state.vertices.Of(edge.frame_b);
      if ((a < 0) == (b < 0)) continue;
      Constraint constraint;
      if (!FillConstraint(edge, 0, constraint).empty()) continue;
      const auto found = known.find((a < 0 ? edge.frame_a : edge.frame_b).str());
      if (found == known.end()) return false;
      const int level = state.vertices.LevelOf(std::max(a, b)) + 1;
      AddVertex(found->second->sensor, found->second->T_ref_sensor, level, state);
    }
  }
  return true;
}

}  // namespace

int LiveVertices::Add(const SensorId& sensor, int level) {
  const int vertex = static_cast<int>(sensors_.size());
  vertex_of_sensor_.emplace(sensor.str(), vertex);
  sensors_.push_back(sensor);
  levels_.push_back(level);
  level_max_ = std::max(level_max_, level);
  return vertex;
}

int LiveVertices::Of(const SensorId& sensor) const {
  const auto found = vertex_of_sensor_.find(sensor.str());
  return found == vertex_of_sensor_.end() ? -1 : found->second;
}

LiveState LiveStateOf(const Graph& graph, const GraphSolution& solution, bool stopped) {
  LiveState state;
  if (!solution.converged && !stopped) {
    state.is_complete = graph.edges.empty();
    return state;
  }
  state.is_complete = AddVertices(graph, solution, state);
  if (!state.is_complete) return state;
  for (const GraphEdge& edge : graph.edges) {
    Constraint constraint;
    if (state.vertices.Of(edge.frame_a) < 0 || state.vertices.Of(edge.frame_b) < 0) continue;
    if (!FillConstraint(edge, 0, constraint).empty()) continue;  // it takes no part
    Place(edge, constraint, state);
    Append(edge.id, constraint, state);
    state.is_complete = state.is_complete && constraint.rank == 6;
  }
  LinearizeGradient(state.problem, state.T_ref, state.equations);
  return state;
}

int AddVertex(const SensorId& sensor, const Se3& T_ref_sensor, int level, LiveState& state) {
  const int vertex = state.vertices.Add(sensor, level);
  ++state.problem.vertex_count;
  state.problem.pattern.block_count = state.problem.free_count();
  state.T_ref.push_back(T_ref_sensor);
  if (vertex > 0) state.equations.H.diagonal.push_back(Matrix6d::Zero());
  return vertex;
}

void Place(const GraphEdge& edge, Constraint& constraint, LiveState& state) {
  constraint.i = state.vertices.Of(edge.frame_a), constraint.j = state.vertices.Of(edge.frame_b);
  constraint.slot = SlotOf(constraint.i, constraint.j, state);
}

void Append(const EdgeId& edge, const Constraint& constraint, LiveState& state) {
  state.problem.constraints.push_back(constraint);
  state.id_of_constraint.push_back(edge);
}

void Erase(std::size_t constraint, LiveState& state) {
  state.problem.constraints[constraint] = state.problem.constraints.back();
  state.id_of_constraint[constraint] = state.id_of_constraint.back();
  state.problem.constraints.pop_back();
  state.id_of_constraint.pop_back();
}

bool ConnectedWithout(std::size_t constraint, const Problem& problem) {
  UnionFind sets(static_cast<std::size_t>(problem.vertex_count));
  int parts = problem.vertex_count;
  for (std::size_t k = 0; k < problem.constraints.size(); ++k)
    if (k != constraint && sets.Join(problem.constraints[k].i, problem.constraints[k].j)) --parts;
  return parts == 1;
}

Se3 PoseAcross(const Constraint& constraint, const Poses& T_ref) {
  return T_ref[static_cast<std::size_t>(constraint.i)].Inverse() * T_ref[static_cast<std::size_t>(constraint.j)];
}

bool MayLeaveBasin(const Constraint& constraint, const Poses& T_ref) {
  return Residual(constraint, T_ref).tail<3>().norm() > kTurnMax_rad;
}

}  // namespace rigcal::graph
