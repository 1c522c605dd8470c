#include "server/graph/solve/solve.h"

#include <algorithm>
#include <string_view>

#include "server/graph/solve/conjugate_gradients.h"
#include "server/graph/solve/observability.h"
#include "server/graph/solve/start_poses.h"
#include "server/math/covariance.h"
#include "server/model/edges/merged_edge.h"

namespace rigcal::graph {
namespace {

int DegreesOfFreedom(const Problem& problem, const Observability& observability) {
  if (!observability.judged) return 0;  // the rank of H is not known
  int rank_sum = 0;
  for (const Constraint& constraint : problem.constraints) rank_sum += constraint.rank;
  return rank_sum - (6 * problem.free_count() - observability.nullity);
}

std::vector<EdgeResidual> ByEdge(const Graph& graph, const Problem& problem, const std::vector<Vector6d>& e) {
  std::vector<EdgeResidual> residuals(graph.edges.size());
  for (std::size_t k = 0; k < residuals.size(); ++k) residuals[k].edge = graph.edges[problem.edges_by_id[k]].id;
  for (std::size_t k = 0; k < e.size(); ++k) {
    const Constraint& constraint = problem.constraints[k];
    EdgeResidual& residual = residuals[constraint.edge];
    residual.in_solution = true;
    residual.e = e[k];
    residual.weighted = residual.e.dot(constraint.Omega * residual.e);
  }
  return residuals;
}

Diagnosis NotObservable(const SensorId& sensor, const SensorId& reference, const FreeBasis& basis) {
  const std::string directions = NameDirections(basis);
  return {"not_observable",
          "the pose of sensor " + sensor.str() + " is not fully determined: its edges leave free " + directions +
              " (in the axes of " + sensor.str() + ")",
          "Add an edge that sees this direction, for example by a session that shows " + sensor.str() +
              " together with a sensor connected to " + reference.str() + " under other orientations."};
}

Diagnosis NotJudged(const SensorId& sensor) {
  return {"not_judged",
          "the pose of sensor " + sensor.str() +
              " cannot be judged: too many sensors hang on edges that do not see every "
              "direction",
          "Add edges that see all six directions between these sensors."};
}

Diagnosis NotConverged(const Optimum& optimum) {
  return {"no_convergence", "the graph did not settle within " + std::to_string(optimum.iterations) + " iterations",
          "Look for edges with a large residual: one that is grossly wrong keeps the graph from settling. "
          "Repeat its session."};
}

Diagnosis Singular() {
  return {"singular",
          "the uncertainty of the solved poses could not be computed: the information of the edges spans "
          "too many orders of magnitude",
          "Check the information matrices of the edges for wrong units (metres and radians)."};
}

// The optimum with the free directions held.
struct Settled {
  Optimum optimum;
  Observability observability;
};

Settled Settle(const Problem& problem, const Poses& start, BlockCholesky<6>& cholesky, int iterations_max) {
  Settled settled;
  settled.observability = Observe(problem, start);
  settled.optimum = Optimize(problem, start, settled.observability.pins, cholesky, iterations_max);
  // What is free may look different at the optimum than at the start.
  constexpr int kRoundsMax = 3;
  for (int round = 0; round < kRoundsMax; ++round) {
    Observability at_optimum = Observe(problem, settled.optimum.T_ref);
    const bool settled_down = at_optimum.pins == settled.observability.pins;
    settled.observability = std::move(at_optimum);
    if (settled_down) break;
    const int iterations_before = settled.optimum.iterations;
    settled.optimum = Optimize(problem, settled.optimum.T_ref, settled.observability.pins, cholesky, iterations_max);
    settled.optimum.iterations += iterations_before;
  }
  return settled;
}

void FillPoses(const Graph& graph, const Problem& problem, const Settled& settled, GraphSolution& solution) {
  for (std::size_t s = 0; s < graph.sensors.size(); ++s) {
    SensorPose& pose = solution.poses[s];
    pose.sensor = graph.sensors[s];
    const int vertex = problem.vertex_of_sensor[s];
    if (vertex < 0) continue;
    const FreeBasis& free = settled.observability.free_of_vertex[static_cast<std::size_t>(vertex)];
    pose.known = free.cols() == 0;
    if (pose.known) {
      pose.T_ref_sensor = settled.optimum.T_ref[static_cast<std::size_t>(vertex)];
    } else {
      if (settled.observability.judged) pose.unobservable_basis = ColumnsOf(Reduced(free));
      solution.diagnoses.push_back(settled.observability.judged ? NotObservable(pose.sensor, graph.reference, free)
                                                                : NotJudged(pose.sensor));
    }
  }
}

void ForgetPoses(const Graph& graph, GraphSolution& solution) {
  for (SensorPose& pose : solution.poses) {
    pose.known = pose.sensor == graph.reference;
    pose.T_ref_sensor = Se3();
  }
}

// Of a sensor whose edges leave some directions open, and not all: the free motions are held in the marginal.
void TakeMeasuredPart(const Se3& T_ref, const Matrix6d& marginal, SensorPose& pose) {
  const FreeBasis open = BasisOf(pose.unobservable_basis);
  if (open.cols() == 0 || open.cols() == 6) return;
  pose.measured_part = MeasuredPart{T_ref, CovarianceAcross(marginal, open)};
}

void FillMarginals(const Graph& graph, const Problem& problem, const Settled& settled, BlockCholesky<6>& cholesky,
                   GraphSolution& solution) {
  if (problem.free_count() == 0) return;
  NormalEquations equations;
  Linearize(problem, settled.optimum.T_ref, equations);
  AddPins(settled.observability.pins, equations.H);
  std::vector<Matrix6d> marginals;
  if (cholesky.Factor(equations.H, 0.0)) marginals = cholesky.InverseDiagonal();
  if (marginals.empty()) {
    solution.diagnoses.push_back(Singular());
    return ForgetPoses(graph, solution);
  }
  for (std::size_t v = 1; v < problem.sensor_of_vertex.size(); ++v) {
    SensorPose& pose = solution.poses[problem.sensor_of_vertex[v]];
    if (pose.known)
      pose.covariance = Symmetrized(marginals[v - 1]);
    else
      TakeMeasuredPart(settled.optimum.T_ref[v], marginals[v - 1], pose);
  }
}

// A graph whose reference is not among its sensors, or that has no sensors: nothing is known.
GraphSolution WithoutReference(const Graph& graph, const Problem& problem) {
  GraphSolution solution;
  solution.diagnoses = problem.diagnoses;
  solution.poses.resize(graph.sensors.size());
  for (std::size_t s = 0; s < graph.sensors.size(); ++s) solution.poses[s].sensor = graph.sensors[s];
  solution.residuals = ByEdge(graph, problem, {});
  solution.converged = graph.sensors.empty();
  return solution;
}

GraphSolution TooLarge(const Graph& graph, const Problem& problem) {
  GraphSolution solution = WithoutReference(graph, problem);
  ForgetPoses(graph, solution);
  solution.diagnoses.push_back({"too_large",
                                "the graph of " + std::to_string(graph.sensors.size()) + " sensors and " +
                                    std::to_string(graph.edges.size()) +
                                    " edges is too densely connected to be solved in " +
                                    std::to_string(kFactorBytesMax >> 30) + " GiB of memory",
                                "Split the robot's sensors into groups, or push fewer edges between distant sensors."});
  return solution;
}

// Along what it leaves open an edge disagrees with nobody: its pose holds there what a drawing or nobody said.
std::vector<Vector6d> WithoutOpenDirections(const Problem& problem, std::vector<Vector6d> residuals) {
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const Constraint& constraint = problem.constraints[k];
    if (constraint.rank == 6) continue;
    const auto open = Observable(constraint.Omega).unobservable_basis;
    residuals[k] -= (open * (open.transpose() * residuals[k])).eval();
  }
  return residuals;
}

// From a start to a GraphSolution: optimum, what is observable, marginals, residuals, errors before and after. That
// before is of `tree_residuals`, by constraint.
GraphSolution OptimizeGraph(const Graph& graph, const Problem& problem, const std::vector<Vector6d>& tree_residuals,
                            const Poses& start, const SolveOptions& options) {
  GraphSolution solution;
  solution.poses.resize(graph.sensors.size());
  solution.diagnoses = problem.diagnoses;
  const auto cholesky = MakeStepSolver(problem);
  if (cholesky == nullptr) return TooLarge(graph, problem);
  const Settled settled = Settle(problem, start, *cholesky, options.iterations_max);
  solution.converged = settled.optimum.converged;
  solution.iterations = settled.optimum.iterations;
  if (!solution.converged) solution.diagnoses.push_back(NotConverged(settled.optimum));
  const std::vector<Vector6d> e =
      WithoutOpenDirections(problem, settled.optimum.residuals.empty() ? Residuals(problem, settled.optimum.T_ref)
                                                                       : settled.optimum.residuals);
  solution.residuals = ByEdge(graph, problem, e);
  for (const EdgeResidual& residual : solution.residuals) solution.cost += residual.weighted;
  solution.before = MeanSquares(WithoutOpenDirections(problem, tree_residuals));
  solution.after = MeanSquares(e);
  solution.dof = DegreesOfFreedom(problem, settled.observability);
  FillPoses(graph, problem, settled, solution);
  if (options.marginals) FillMarginals(graph, problem, settled, *cholesky, solution);
  return solution;
}

constexpr double kTreeIsGood_rad = 0.5;  // below this residual rotation everywhere, a tree lies in the optimum's basin

bool StartSuffices(const Problem& problem, const std::vector<Vector6d>& residuals) {
  if (static_cast<int>(problem.constraints.size()) == problem.free_count()) return true;  // no loop: it is the optimum
  if (problem.free_count() > kBlocksDenseMax && !PrefersConjugateGradients(problem)) return false;
  return std::all_of(residuals.begin(), residuals.end(),
                     [](const Vector6d& e) { return e.tail<3>().norm() < kTreeIsGood_rad; });
}

bool IsNumeric(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

std::string_view WithoutLeadingZeros(std::string_view digits) {
  const std::size_t first = digits.find_first_not_of('0');
  return first == std::string_view::npos ? std::string_view() : digits.substr(first);
}

GraphEdge MeasurementOf(const Edge& edge) {
  return {edge.id,
          edge.frame_a,
          edge.frame_b,
          edge.T_a_b,
          edge.uncertainty.Omega,
          edge.uncertainty.rank,
          edge.uncertainty.dof,
          IsMergedOfSessions(edge) ? kMergedHistory : edge.session};
}

}  // namespace

bool SensorBefore(const SensorId& a, const SensorId& b) {
  const bool a_numeric = IsNumeric(a.str()), b_numeric = IsNumeric(b.str());
  if (a_numeric != b_numeric) return a_numeric;
  if (!a_numeric) return a < b;
  const std::string_view a_digits = WithoutLeadingZeros(a.str()), b_digits = WithoutLeadingZeros(b.str());
  if (a_digits.size() != b_digits.size()) return a_digits.size() < b_digits.size();
  if (a_digits != b_digits) return a_digits < b_digits;
  return a < b;  // "7" and "07"
}

Graph GraphOf(const std::vector<Edge>& edges, const SensorId& reference) {
  Graph graph;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    graph.edges.push_back(MeasurementOf(edge));
    graph.sensors.push_back(edge.frame_a);
    graph.sensors.push_back(edge.frame_b);
  }
  std::sort(graph.sensors.begin(), graph.sensors.end(), SensorBefore);
  graph.sensors.erase(std::unique(graph.sensors.begin(), graph.sensors.end()), graph.sensors.end());
  const bool present = std::binary_search(graph.sensors.begin(), graph.sensors.end(), reference, SensorBefore);
  if (present) {
    graph.reference = reference;
  } else if (!graph.sensors.empty()) {
    graph.reference = graph.sensors.front();
  }
  return graph;
}

GlobalError MeanSquares(const std::vector<Vector6d>& residuals) {
  GlobalError error;
  if (residuals.empty()) return error;
  for (const Vector6d& e : residuals) {
    error.translation_m2 += e.head<3>().squaredNorm();
    error.rotation_rad2 += e.tail<3>().squaredNorm();
  }
  const auto count = static_cast<double>(residuals.size());
  error.translation_m2 /= count;
  error.rotation_rad2 /= count;
  error.total = error.translation_m2 + error.rotation_rad2;
  return error;
}

GraphSolution Solve(const Graph& graph, const SolveOptions& options) {
  const Problem problem = MakeProblem(graph);
  if (problem.vertex_count == 0) return WithoutReference(graph, problem);
  Poses start = SpanningTreePoses(problem);
  const std::vector<Vector6d> tree_residuals = Residuals(problem, start);
  if (!StartSuffices(problem, tree_residuals)) {
    std::optional<Poses> chordal = ChordalPoses(problem);
    if (chordal && Cost(problem, *chordal) < Cost(problem, tree_residuals)) start = std::move(*chordal);
  }
  return OptimizeGraph(graph, problem, tree_residuals, start, options);
}

}  // namespace rigcal::graph
