#include "server/graph/live_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/graph/conjugate_gradients.h"
#include "server/graph/dense_cholesky.h"
#include "server/graph/sensor_order.h"

namespace rigcal::graph {
namespace {

constexpr int kLevelsMax = 12;           // deeper graphs are badly conditioned for conjugate gradients
constexpr double kStepMax = 0.05;        // m and rad: a larger step may leave the basin, so the batch decides
constexpr double kRestRelative = 1e-11;  // of the cost: what may be left to gain
constexpr double kShrink = 0.1;          // what a gain must be of the one before
constexpr double kShrinkLeast = 0.01;    // one good step does not promise that the next shrinks as well
constexpr int kStepsMax = 12, kStepsFresh = 5;

}  // namespace

UpdateWork LiveSolver::Add(const GraphEdge& edge) {
  graph_.edges.push_back(edge);
  const bool was_known = VertexOf(edge.frame_a) >= 0 && VertexOf(edge.frame_b) >= 0;
  if (!was_known) InsertSensor(edge.frame_a), InsertSensor(edge.frame_b);
  Constraint constraint;
  if (!fast_) return Rebuild();
  if (!FillConstraint(edge, 0, constraint).empty()) return {};
  if (constraint.rank < 6) return Rebuild();
  UpdateWork work;
  if (was_known) {
    Place(edge, constraint);
    return constraint.i != constraint.j && Relax(constraint, work) ? work : Rebuild();
  }
  return Connect(edge, constraint) ? work : Rebuild();
}

UpdateWork LiveSolver::AddSensor(const SensorId& sensor) {
  InsertSensor(sensor);
  return {};
}

UpdateWork LiveSolver::Remove(const EdgeId& edge) {
  const auto removed = std::remove_if(graph_.edges.begin(), graph_.edges.end(),
                                      [&edge](const GraphEdge& candidate) { return candidate.id == edge; });
  if (removed == graph_.edges.end()) return {};
  graph_.edges.erase(removed, graph_.edges.end());
  return Rebuild();
}

UpdateWork LiveSolver::Reweight(const EdgeId& edge, const Matrix6d& Omega, int rank) {
  bool found = false;
  for (GraphEdge& candidate : graph_.edges) {
    if (candidate.id != edge) continue;
    candidate.Omega = Omega;
    candidate.rank = rank;
    found = true;
  }
  return found ? Rebuild() : UpdateWork{};
}

GraphSolution LiveSolver::Solution(const SolveOptions& options) const {
  if (!fast_ && !options.marginals) return solution_;
  GraphSolution start;
  for (std::size_t v = 0; v < sensor_of_vertex_.size() && fast_; ++v)
    start.poses.push_back({sensor_of_vertex_[v], true, T_ref_[v], Matrix6d::Zero()});
  return Update(graph_, fast_ ? start : solution_, options);
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
    const GraphSolution solution = Solution();
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

UpdateWork LiveSolver::Rebuild() {
  UpdateWork work;
  work.batch = true;
  SolveOptions options;
  options.marginals = false;
  solution_ = Solve(graph_, options);
  work.iterations = solution_.iterations;
  work.edges_evaluated = static_cast<int>(graph_.edges.size()) * (solution_.iterations + 1);
  fast_ = AdoptSolution();
  return work;
}

// Breadth first from the reference, so that levels are right. False if the fast way does not apply.
bool LiveSolver::AdoptSolution() {
  vertex_of_sensor_.clear(), sensor_of_vertex_.clear(), level_.clear(), slot_of_pair_.clear();
  *problem_ = Problem();
  T_ref_.clear();
  equations_ = NormalEquations();
  solver_.reset();
  stale_ = true;
  factored_count_ = 0;
  if (!solution_.converged) return graph_.edges.empty();
  std::unordered_map<std::string, const SensorPose*> known;
  for (const SensorPose& pose : solution_.poses)
    if (pose.known) known.emplace(pose.sensor.str(), &pose);
  if (known.contains(graph_.reference.str())) AddVertex(graph_.reference, Se3(), 0);
  bool full = true;
  for (std::size_t before = 0; before != sensor_of_vertex_.size();) {
    before = sensor_of_vertex_.size();
    for (const GraphEdge& edge : graph_.edges) {
      const int a = VertexOf(edge.frame_a), b = VertexOf(edge.frame_b);
      full = full && edge.rank == 6;
      if ((a < 0) == (b < 0)) continue;
      const auto found = known.find((a < 0 ? edge.frame_a : edge.frame_b).str());
      if (found == known.end()) return false;
      AddVertex(found->second->sensor, found->second->T_ref_sensor,
                level_[static_cast<std::size_t>(std::max(a, b))] + 1);
    }
  }
  for (const GraphEdge& edge : graph_.edges) {
    Constraint constraint;
    if (VertexOf(edge.frame_a) < 0 || VertexOf(edge.frame_b) < 0) continue;
    if (!FillConstraint(edge, 0, constraint).empty()) return false;
    Place(edge, constraint);
    problem_->constraints.push_back(constraint);
  }
  return full &&
         (problem_->free_count() <= kBlocksDenseMax || *std::max_element(level_.begin(), level_.end()) <= kLevelsMax);
}

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
  T_ref_.push_back(T_ref_sensor);
  if (vertex > 0) equations_.H.diagonal.push_back(Matrix6d::Zero());
  return vertex;
}

void LiveSolver::InsertSensor(const SensorId& sensor) {
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

void LiveSolver::Place(const GraphEdge& edge, Constraint& constraint) {
  constraint.i = VertexOf(edge.frame_a), constraint.j = VertexOf(edge.frame_b);
  constraint.slot = SlotOf(constraint.i, constraint.j);
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
  if (waiting > 1 || (problem_->free_count() >= kBlocksDenseMax && level > kLevelsMax)) return false;
  const Se3& T_ref_known = T_ref_[static_cast<std::size_t>(std::max(a, b))];
  AddVertex(sensor, (T_ref_known * (a < 0 ? constraint.T_j_i : constraint.T_i_j)).Normalized(), level);
  Place(edge, constraint);
  problem_->constraints.push_back(constraint);
  LinearizeEdge(constraint, T_ref_, equations_.H);
  dirty_from_ = std::min(dirty_from_, std::max(std::min(constraint.i, constraint.j) - 1, 0));
  return true;
}

bool LiveSolver::FactorNow(UpdateWork& work) {
  const int count = problem_->free_count();
  if (stale_) Linearize(*problem_, T_ref_, equations_);
  if (stale_ || count != factored_count_) dirty_from_ = 0;
  stale_ = false;
  work.columns_factored += count - dirty_from_;
  const int first = std::exchange(dirty_from_, count);
  if (count > kBlocksDenseMax) {
    if (count != factored_count_) solver_ = std::make_unique<ConjugateGradients>(problem_->pattern);
    factored_count_ = count;
    return solver_->Factor(equations_.H, 0.0);
  }
  if (count != factored_count_) solver_ = std::make_unique<DenseCholesky<6>>(problem_->pattern);
  factored_count_ = count;
  return static_cast<DenseCholesky<6>&>(*solver_).FactorFrom(static_cast<std::size_t>(first), equations_.H, 0.0);
}

// Before the edge the gradient was zero, so the first step needs the edge's own alone.
bool LiveSolver::Relax(const Constraint& added, UpdateWork& work) {
  equations_.g.setZero(6 * problem_->free_count());
  LinearizeEdge(added, T_ref_, equations_.H, &equations_.g);
  problem_->constraints.push_back(added);
  dirty_from_ = std::min(dirty_from_, std::max(std::min(added.i, added.j) - 1, 0));
  if (!FactorNow(work)) return false;
  secants_.Clear();
  double gain_before = std::numeric_limits<double>::infinity();
  for (work.iterations = 1; work.iterations <= kStepsMax; ++work.iterations) {
    step_ = -equations_.g;
    secants_.Apply(step_, [this](Eigen::VectorXd& x) { solver_->SolveInPlace(x); });
    const double gain = -step_.dot(equations_.g);
    if (!std::isfinite(gain) || step_.cwiseAbs().maxCoeff() > kStepMax) return false;
    Retract(T_ref_, step_, trial_);
    std::swap(T_ref_, trial_);
    const double ratio = gain / gain_before;
    if (work.iterations > 2 && ratio > kShrink && gain > kRestRelative * equations_.cost) return false;
    if (work.iterations > 1 && std::clamp(ratio, kShrinkLeast, kShrink) * gain <= kRestRelative * equations_.cost)
      break;
    gain_before = gain;
    g_before_ = equations_.g;
    LinearizeGradient(*problem_, T_ref_, equations_);
    work.edges_evaluated += static_cast<int>(problem_->constraints.size());
    if (work.iterations > 1) secants_.Remember(step_, equations_.g - g_before_);
  }
  stale_ = work.iterations > kStepsFresh;
  return work.iterations <= kStepsMax;
}

}  // namespace rigcal::graph
