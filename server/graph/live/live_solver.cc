#include "server/graph/live/live_solver.h"

#include <algorithm>
#include <limits>

#include "server/graph/solve/conjugate_gradients.h"
#include "server/graph/solve/start_poses.h"

namespace rigcal::graph {
namespace {

constexpr int kLevelsMax = 12;  // deeper graphs are badly conditioned for conjugate gradients
constexpr int kIterationsLeast = 5, kIterationsMost = 100;  // of a batch within an update
constexpr double kRoundsTypical = 30.0;                     // of conjugate gradients in an iteration, by experience

// About: of a factor and a solve, or of conjugate gradients.
double ProductsOfIteration(const Problem& problem) {
  const double count = problem.free_count(), links = static_cast<double>(problem.pattern.off_diagonal.size());
  if (problem.free_count() <= kBlocksDenseMax) return count * (count + 1.0) * (count + 2.0) / 6.0;
  if (PrefersConjugateGradients(problem)) return kRoundsTypical * (count + links) / 3.0;
  return problem.elimination_cost.flops + problem.elimination_cost.entries / 3.0;
}

}  // namespace

UpdateWork LiveSolver::Add(const GraphEdge& edge) {
  graph_.edges.push_back(edge);
  const bool was_known = VertexOf(edge.frame_a) >= 0 && VertexOf(edge.frame_b) >= 0;
  if (!was_known) AddSensor(edge.frame_a), AddSensor(edge.frame_b);
  Constraint constraint;
  if (!fast_) return Rebuild();
  if (!FillConstraint(edge, 0, constraint).empty()) return {};
  if (constraint.rank < 6) return Rebuild();
  UpdateWork work;
  if (was_known) {
    Place(edge, constraint);
    if (constraint.i == constraint.j) return Rebuild();
    return (deep() ? RelaxDeep(constraint, work) : Relax(constraint, work)) ? work : Rebuild(work);
  }
  return Connect(edge, constraint) ? work : Rebuild(work);
}

GraphSolution LiveSolver::Glance() const {
  if (!fast_) return solution_;
  GraphSolution glance;
  glance.converged = solution_.converged || settled_;
  for (const SensorId& sensor : graph_.sensors) {
    const std::optional<Se3> T = PoseOf(sensor);
    glance.poses.push_back({sensor, T.has_value(), T.value_or(Se3()), Matrix6d::Zero()});
  }
  const std::vector<Vector6d> e = Residuals(*problem_, T_ref_);
  glance.cost = graph::Cost(*problem_, e);
  glance.after = MeanSquares(e);
  const Problem canonical = MakeProblem(graph_);  // edges of equal certainty count in the order of their ids
  if (canonical.vertex_count > 0) glance.before = MeanSquares(Residuals(canonical, SpanningTreePoses(canonical)));
  glance.dof = 6 * (static_cast<int>(e.size()) - problem_->free_count());
  return glance;
}

std::optional<Se3> LiveSolver::PoseOf(const SensorId& sensor) const {
  if (fast_) {
    const int vertex = VertexOf(sensor);
    return vertex < 0 ? std::nullopt : std::optional(T_ref_[static_cast<std::size_t>(vertex)]);
  }
  for (const SensorPose& pose : solution_.poses)
    if (pose.sensor == sensor && pose.known) return pose.T_ref_sensor;
  return std::nullopt;
}

std::vector<std::pair<SensorId, Matrix6d>> LiveSolver::Marginals() const {
  std::vector<std::pair<SensorId, Matrix6d>> marginals;
  if (!fast_) {
    const GraphSolution solution = Solve(graph_);
    for (const SensorPose& pose : solution.poses)
      if (pose.known) marginals.emplace_back(pose.sensor, pose.covariance);
    return marginals;
  }
  NormalEquations equations;
  Linearize(*problem_, T_ref_, equations);
  const auto cholesky = MakeCholesky<6>(problem_->pattern, std::numeric_limits<int>::max());
  if (!cholesky->Factor(equations.H, 0.0)) return {};
  const std::vector<Matrix6d> blocks = cholesky->InverseDiagonal();
  marginals.emplace_back(graph_.reference, Matrix6d::Zero());
  for (std::size_t v = 0; v < blocks.size(); ++v) marginals.emplace_back(sensor_of_vertex_[v + 1], blocks[v]);
  return marginals;
}

UpdateWork LiveSolver::Settle() {
  const UpdateBudget budget = std::exchange(budget_, UpdateBudget{std::numeric_limits<int>::max()});
  const UpdateWork work = Rebuild();
  budget_ = budget;
  return work;
}

UpdateWork LiveSolver::Rebuild(UpdateWork work) {
  work.batch = true;
  SolveOptions options;
  options.marginals = false;
  const double products = ProductsOfIteration(MakeProblem(graph_));
  if (large() && products > 0.0)
    options.iterations_max =
        static_cast<int>(std::clamp<double>(budget_.products_max / products, kIterationsLeast, kIterationsMost));
  solution_ = Solve(graph_, options);
  work.iterations += solution_.iterations;
  work.edges_evaluated += static_cast<int>(graph_.edges.size()) * (solution_.iterations + 1);
  work.products += solution_.iterations * products;
  work.rest_ratio = 0.0;
  settled_ = solution_.converged;
  fast_ = AdoptSolution(solution_.iterations >= options.iterations_max);
  return work;
}

// Breadth first from the reference, so that levels are right. False if the fast way does not apply. A batch that was
// `stopped` is a state to go on from.
bool LiveSolver::AdoptSolution(bool stopped) {
  vertex_of_sensor_.clear(), sensor_of_vertex_.clear(), level_.clear(), slot_of_pair_.clear();
  id_of_constraint_.clear();
  level_max_ = 0;
  tree_holds_ = false;
  *problem_ = Problem();
  T_ref_.clear();
  equations_ = NormalEquations();
  solver_.reset();
  stale_ = true;
  factored_count_ = 0;
  if (!solution_.converged && !stopped) return graph_.edges.empty();
  std::unordered_map<std::string, const SensorPose*> known;
  for (const SensorPose& pose : solution_.poses)
    if (pose.known) known.emplace(pose.sensor.str(), &pose);
  if (known.contains(graph_.reference.str())) AddVertex(graph_.reference, Se3(), 0);
  bool full = true;
  for (std::size_t before = 0; before != sensor_of_vertex_.size();) {
    before = sensor_of_vertex_.size();
    for (const GraphEdge& edge : graph_.edges) {
      const int a = VertexOf(edge.frame_a), b = VertexOf(edge.frame_b);
      if ((a < 0) == (b < 0)) continue;
      Constraint constraint;
      if (!FillConstraint(edge, 0, constraint).empty()) continue;
      const auto found = known.find((a < 0 ? edge.frame_a : edge.frame_b).str());
      if (found == known.end()) return false;
      AddVertex(found->second->sensor, found->second->T_ref_sensor,
                level_[static_cast<std::size_t>(std::max(a, b))] + 1);
    }
  }
  for (const GraphEdge& edge : graph_.edges) {
    Constraint constraint;
    if (VertexOf(edge.frame_a) < 0 || VertexOf(edge.frame_b) < 0) continue;
    if (!FillConstraint(edge, 0, constraint).empty()) continue;  // it takes no part
    Place(edge, constraint);
    problem_->constraints.push_back(constraint);
    full = full && constraint.rank == 6;
  }
  LinearizeGradient(*problem_, T_ref_, equations_);
  return full;
}

bool LiveSolver::deep() const { return problem_->free_count() > kBlocksDenseMax && level_max_ > kLevelsMax; }

int LiveSolver::VertexOf(const SensorId& sensor) const {
  const auto found = vertex_of_sensor_.find(sensor.str());
  return found == vertex_of_sensor_.end() ? -1 : found->second;
}

int LiveSolver::AddVertex(const SensorId& sensor, const Se3& T_ref_sensor, int level) {
  const int vertex = problem_->vertex_count++;
  problem_->pattern.block_count = problem_->free_count();
  vertex_of_sensor_.emplace(sensor.str(), vertex);
  sensor_of_vertex_.push_back(sensor);
  level_.push_back(level);
  level_max_ = std::max(level_max_, level);
  T_ref_.push_back(T_ref_sensor);
  if (vertex > 0) equations_.H.diagonal.push_back(Matrix6d::Zero());
  return vertex;
}

void LiveSolver::AddSensor(const SensorId& sensor) {
  std::vector<SensorId>& sensors = graph_.sensors;
  const auto at = std::lower_bound(sensors.begin(), sensors.end(), sensor, SensorBefore);
  if (at == sensors.end() || *at != sensor) sensors.insert(at, sensor);
  if (sensor == graph_.reference && VertexOf(sensor) < 0 && fast_) AddVertex(sensor, Se3(), 0);
}

int LiveSolver::SlotOf(int i, int j) {
  const int row = std::max(i, j) - 1, col = std::min(i, j) - 1;
  if (col < 0) return -1;
  const auto [at, is_new] = slot_of_pair_.try_emplace((static_cast<std::int64_t>(row) << 32) + col,
                                                      static_cast<int>(problem_->pattern.off_diagonal.size()));
  if (is_new) {
    problem_->pattern.off_diagonal.push_back({row, col});
    equations_.H.off_diagonal.push_back(Matrix6d::Zero());
  }
  return at->second;
}

// The constraint's vertices; it is to be the next of problem_.
void LiveSolver::Place(const GraphEdge& edge, Constraint& constraint) {
  constraint.i = VertexOf(edge.frame_a), constraint.j = VertexOf(edge.frame_b);
  constraint.slot = SlotOf(constraint.i, constraint.j);
  id_of_constraint_.push_back(edge.id);
}

// A sensor that hangs on one edge moves nothing else. False if this edge is more than that: it joins two parts.
bool LiveSolver::Connect(const GraphEdge& edge, Constraint& constraint) {
  if (edge.frame_a == edge.frame_b) return true;
  const int a = VertexOf(edge.frame_a), b = VertexOf(edge.frame_b);
  if (a < 0 && b < 0) return true;
  const SensorId& sensor = a < 0 ? edge.frame_a : edge.frame_b;
  const auto waiting = std::count_if(graph_.edges.begin(), graph_.edges.end(), [&sensor](const GraphEdge& other) {
    return other.frame_a == sensor || other.frame_b == sensor;
  });
  const int level = level_[static_cast<std::size_t>(std::max(a, b))] + 1;
  if (waiting > 1) return false;
  const Se3& T_ref_known = T_ref_[static_cast<std::size_t>(std::max(a, b))];
  AddVertex(sensor, (T_ref_known * (a < 0 ? constraint.T_j_i : constraint.T_i_j)).Normalized(), level);
  Place(edge, constraint);
  problem_->constraints.push_back(constraint);
  LinearizeEdge(constraint, T_ref_, equations_.H);
  GrowLeaf();
  dirty_from_ = std::min(dirty_from_, std::max(std::min(constraint.i, constraint.j) - 1, 0));
  return true;
}

}  // namespace rigcal::graph
