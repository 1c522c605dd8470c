// The graph of one robot as numbers that stay from update to update: vertices numbered as their sensors came, the
// constraints between them, H, and the best poses known. Values and what changes them with the graph; how the poses are
// brought to the optimum is `shallow_descent.h` and `deep_descent.h`. Beside them what an update may take, and took.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "server/graph/solve/gauss_newton.h"
#include "server/graph/solve/linearize.h"

namespace rigcal::graph {

// What an update cost.
struct UpdateWork {
  int iterations = 0;        // steps taken
  int columns_factored = 0;  // block columns of the factor that were renewed
  double products = 0.0;     // of 6x6 blocks, in factors and solves: what the budget counts (of a batch: about)
  double rest_ratio = 0.0;   // of the cost: what is left to gain, as far as is known
  bool batch = false;        // solved from the ground up: a large step, a deficient edge, parts that meet or fall apart
};

// How far an update goes. Counts of work and not of time, so that the same edges give the same poses everywhere.
struct UpdateBudget {
  int sensors_exact_max = 200;  // up to this many, every update ends at the optimum to 1e-9 of the cost
  double rest_ratio = 3e-4;     // of the cost: beyond, an update stops where no more than this is left to gain,
  double products_max = 4e6;    // or before the step that would take more (about a second)

  // Whether a graph of so many vertices is beyond what is kept exact.
  [[nodiscard]] bool IsLarge(const Problem& problem) const { return problem.vertex_count > sensors_exact_max; }
};

// Sensors by vertex, numbered from 0 as they come. A vertex's level is how many edges it was from the reference when it
// came.
class LiveVertices {
 public:
  // The number of the new vertex of a sensor that has none.
  int Add(const SensorId& sensor, int level);
  // -1: none.
  [[nodiscard]] int Of(const SensorId& sensor) const;
  // Of a vertex that is there.
  [[nodiscard]] const SensorId& SensorOf(int vertex) const { return sensors_[static_cast<std::size_t>(vertex)]; }
  [[nodiscard]] int LevelOf(int vertex) const { return levels_[static_cast<std::size_t>(vertex)]; }
  // Of all vertices; 0 without any.
  [[nodiscard]] int level_max() const { return level_max_; }

 private:
  std::unordered_map<std::string, int> vertex_of_sensor_;
  std::vector<SensorId> sensors_;
  std::vector<int> levels_;
  int level_max_ = 0;
};

// Vectors of a descent, kept so that an update allocates nothing.
struct DescentWorkspace {
  SecantPairs secants;
  Eigen::VectorXd step, g_before;
  Poses trial;
};

// Factors read the pattern and H of a state where they are: it is not moved while they live.
struct LiveState {
  LiveVertices vertices;
  Problem problem;  // its constraints and pattern only
  std::vector<EdgeId> id_of_constraint;
  std::unordered_map<std::int64_t, int> slot_of_pair;  // of H, by row and column
  Poses T_ref;
  NormalEquations equations;
  bool is_complete = true;  // false: an edge is deficient, or a pose unknown; then only batch solutions count
  DescentWorkspace workspace;
};

// The state at the poses of a solution of `graph`, vertices breadth first from the reference so that levels are right.
// A batch that was `stopped` before it converged is a state to go on from.
[[nodiscard]] LiveState LiveStateOf(const Graph& graph, const GraphSolution& solution, bool stopped);

// The number of a new vertex. The reference is the first, with the identity and level 0.
int AddVertex(const SensorId& sensor, const Se3& T_ref_sensor, int level, LiveState& state);
// Sets vertices and slot of the constraint of `edge`, whose frames both have vertices.
void Place(const GraphEdge& edge, Constraint& constraint, LiveState& state);
// A constraint that was placed becomes the last one.
void Append(const EdgeId& edge, const Constraint& constraint, LiveState& state);
// The last constraint takes the number of this one, which is no more.
void Erase(std::size_t constraint, LiveState& state);

// Whether all vertices hang together without this constraint.
[[nodiscard]] bool ConnectedWithout(std::size_t constraint, const Problem& problem);
// T_i_j at these poses.
[[nodiscard]] Se3 PoseAcross(const Constraint& constraint, const Poses& T_ref);
// An edge that disagrees by much may hold the poses in one basin of the cost, or pull them into another.
[[nodiscard]] bool MayLeaveBasin(const Constraint& constraint, const Poses& T_ref);

}  // namespace rigcal::graph
