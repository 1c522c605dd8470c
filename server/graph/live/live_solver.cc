#include "server/graph/live/live_solver.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "server/graph/solve/conjugate_gradients.h"
#include "server/graph/solve/start_poses.h"

namespace rigcal::graph {
namespace {

constexpr int kLevelsMax = 12;  // deeper graphs are badly conditioned for conjugate gradients
constexpr int kIterationsLeast = 5, kIterationsMost = 100;  // of a batch within an update
constexpr double kRoundsTypical = 30.0;                     // of conjugate gradients in an iteration, by experience
constexpr double kSettledRelative = 1e-9;                   // of the cost: what is left to gain at an optimum

// About: of a factor and a solve, or of conjugate gradients.
double ProductsOfIteration(const Problem& problem) {
  const double count = problem.free_count(), links = static_cast<double>(problem.pattern.off_diagonal.size());
  if (problem.free_count() <= kBlocksDenseMax) return count * (count + 1.0) * (count + 2.0) / 6.0;
  if (PrefersConjugateGradients(problem)) return kRoundsTypical * (count + links) / 3.0;
  return problem.elimination_cost.flops + problem.elimination_cost.entries / 3.0;
}

bool IsDeep(const LiveState& state) {
  return state.problem.free_count() > kBlocksDenseMax && state.vertices.level_max() > kLevelsMax;
}

// An edge between vertices that are there, into the poses. False if the batch decides.
bool Join(const GraphEdge& edge, Constraint& constraint, const UpdateBudget& budget, LiveNumbers& numbers,
          UpdateWork& work) {
  LiveState& state = numbers.state;
  if (edge.frame_a == edge.frame_b) return false;
  const bool deep = IsDeep(state);
  Place(edge, constraint, state);
  if (deep && MayLeaveBasin(constraint, state.T_ref)) return false;
  Append(edge.id, constraint, state);
  if (!deep) return DescendWithNewest(budget, numbers.shallow, state, work);
  numbers.shallow.stale = true;
  return DescendWithNewest(budget, numbers.deep, state, work);
}

// An edge with a sensor that has no vertex yet: one that hangs on it moves nothing else. False if the edge is more than
// that, as it joins two parts.
bool Connect(const Graph& graph, const GraphEdge& edge, Constraint& constraint, LiveNumbers& numbers) {
  LiveState& state = numbers.state;
  const int known = std::max(state.vertices.Of(edge.frame_a), state.vertices.Of(edge.frame_b));
  if (edge.frame_a == edge.frame_b || known < 0) return true;
  const bool comes_first = state.vertices.Of(edge.frame_a) < 0;
  const SensorId& sensor = comes_first ? edge.frame_a : edge.frame_b;
  const auto waiting = std::count_if(graph.edges.begin(), graph.edges.end(), [&sensor](const GraphEdge& other) {
    return other.frame_a == sensor || other.frame_b == sensor;
  });
  if (waiting > 1) return false;
  const Se3& T_ref_known = state.T_ref[static_cast<std::size_t>(known)];
  AddVertex(sensor, (T_ref_known * (comes_first ? constraint.T_j_i : constraint.T_i_j)).Normalized(),
            state.vertices.LevelOf(known) + 1, state);
  Place(edge, constraint, state);
  Append(edge.id, constraint, state);
  LinearizeEdge(constraint, state.T_ref, state.equations.H);
  AddLeaf(numbers.deep, state);
  TouchColumns(constraint, numbers.shallow);
  return true;
}

// H loses what an edge that leaves brought, and the descent goes on from the poses at hand: the same cliques change as
// when the edge came. False if the batch decides.
bool Leave(std::size_t constraint, const UpdateBudget& budget, LiveNumbers& numbers, UpdateWork& work) {
  LiveState& state = numbers.state;
  if (!ConnectedWithout(constraint, state.problem)) return false;
  if (MayLeaveBasin(state.problem.constraints[constraint], state.T_ref)) return false;
  Drop(constraint, state, numbers.deep);
  Erase(constraint, state);
  numbers.shallow.stale = true;
  // H is made anew where it holds what is no longer so: in a tree of cliques, above what changed; else everywhere.
  return IsDeep(state) ? DescendWithout(budget, numbers.deep, state, work)
                       : DescendWithout(budget, numbers.shallow, state, work);
}

}  // namespace

UpdateWork LiveSolver::Add(const GraphEdge& edge) {
  graph_.edges.push_back(edge);
  const LiveState& state = numbers_->state;
  const bool was_known = state.vertices.Of(edge.frame_a) >= 0 && state.vertices.Of(edge.frame_b) >= 0;
  if (!was_known) AddSensor(edge.frame_a), AddSensor(edge.frame_b);
  Constraint constraint;
  if (!state.is_complete) return Rebuild(budget_);
  if (!FillConstraint(edge, 0, constraint).empty()) return {};
  if (constraint.rank < 6) return Rebuild(budget_);
  UpdateWork work;
  if (!was_known) return Connect(graph_, edge, constraint, *numbers_) ? work : Rebuild(budget_, work);
  if (!Join(edge, constraint, budget_, *numbers_, work)) return Rebuild(budget_, work);
  settled_ = work.rest_ratio <= kSettledRelative;
  return work;
}

UpdateWork LiveSolver::Remove(const EdgeId& edge) {
  if (const auto count = std::erase_if(graph_.edges, [&edge](const GraphEdge& one) { return one.id == edge; });
      count != 1 || !numbers_->state.is_complete)
    return count == 0 ? UpdateWork() : Rebuild(budget_);
  const std::vector<EdgeId>& ids = numbers_->state.id_of_constraint;
  const auto found = std::find(ids.begin(), ids.end(), edge);
  if (found == ids.end()) return {};  // it took no part
  UpdateWork work;
  if (!Leave(static_cast<std::size_t>(found - ids.begin()), budget_, *numbers_, work)) return Rebuild(budget_, work);
  settled_ = work.rest_ratio <= kSettledRelative;
  return work;
}

void LiveSolver::AddSensor(const SensorId& sensor) {
  std::vector<SensorId>& sensors = graph_.sensors;
  const auto at = std::lower_bound(sensors.begin(), sensors.end(), sensor, SensorBefore);
  if (at == sensors.end() || *at != sensor) sensors.insert(at, sensor);
  LiveState& state = numbers_->state;
  if (sensor == graph_.reference && state.vertices.Of(sensor) < 0 && state.is_complete)
    AddVertex(sensor, Se3(), 0, state);
}

UpdateWork LiveSolver::Settle() { return Rebuild(UpdateBudget{std::numeric_limits<int>::max()}); }

UpdateWork LiveSolver::Rebuild(const UpdateBudget& budget, UpdateWork work) {
  work.batch = true;
  SolveOptions options;
  options.marginals = false;
  const double products = ProductsOfIteration(MakeProblem(graph_));
  if (budget.IsLarge(numbers_->state.problem) && products > 0.0)
    options.iterations_max =
        static_cast<int>(std::clamp<double>(budget.products_max / products, kIterationsLeast, kIterationsMost));
  solution_ = Solve(graph_, options);
  work.iterations += solution_.iterations;
  work.products += solution_.iterations * products;
  work.rest_ratio = 0.0;
  settled_ = solution_.converged;
  numbers_ = std::make_unique<LiveNumbers>();
  numbers_->state = LiveStateOf(graph_, solution_, solution_.iterations >= options.iterations_max);
  return work;
}

std::optional<Se3> LiveSolver::PoseOf(const SensorId& sensor) const {
  const LiveState& state = numbers_->state;
  if (state.is_complete) {
    const int vertex = state.vertices.Of(sensor);
    return vertex < 0 ? std::nullopt : std::optional(state.T_ref[static_cast<std::size_t>(vertex)]);
  }
  for (const SensorPose& pose : solution_.poses)
    if (pose.sensor == sensor && pose.known) return pose.T_ref_sensor;
  return std::nullopt;
}

GraphSolution LiveSolver::Snapshot() const {
  const LiveState& state = numbers_->state;
  if (!state.is_complete) return solution_;
  GraphSolution snapshot;
  snapshot.converged = solution_.converged || settled_;
  for (const SensorId& sensor : graph_.sensors) {
    const std::optional<Se3> T = PoseOf(sensor);
    snapshot.poses.push_back({sensor, T.has_value(), T.value_or(Se3()), Matrix6d::Zero()});
  }
  const std::vector<Vector6d> e = Residuals(state.problem, state.T_ref);
  snapshot.cost = Cost(state.problem, e);
  snapshot.after = MeanSquares(e);
  const Problem canonical = MakeProblem(graph_);  // edges of equal certainty count in the order of their ids
  if (canonical.vertex_count > 0) snapshot.before = MeanSquares(Residuals(canonical, SpanningTreePoses(canonical)));
  snapshot.dof = 6 * (static_cast<int>(e.size()) - state.problem.free_count());
  return snapshot;
}

std::vector<std::pair<SensorId, Matrix6d>> LiveSolver::Marginals() const {
  std::vector<std::pair<SensorId, Matrix6d>> marginals;
  const LiveState& state = numbers_->state;
  if (!state.is_complete) {
    const GraphSolution solution = Solve(graph_);
    for (const SensorPose& pose : solution.poses)
      if (pose.known) marginals.emplace_back(pose.sensor, pose.covariance);
    return marginals;
  }
  NormalEquations equations;
  Linearize(state.problem, state.T_ref, equations);
  const auto cholesky = MakeCholesky<6>(state.problem.pattern, std::numeric_limits<int>::max());
  if (!cholesky->Factor(equations.H, 0.0)) return {};
  const std::vector<Matrix6d> blocks = cholesky->InverseDiagonal();
  marginals.emplace_back(graph_.reference, Matrix6d::Zero());
  for (std::size_t v = 0; v < blocks.size(); ++v)
    marginals.emplace_back(state.vertices.SensorOf(static_cast<int>(v) + 1), blocks[v]);
  return marginals;
}

}  // namespace rigcal::graph
