// The live state of one robot's graph, kept at the optimum while edges come and go. It remembers poses, H and its
// factor between updates, so that an edge costs a few passes over the residuals. One thread.
//
// Small graphs have a dense factor, shallow ones are solved by conjugate gradients, deep ones have a factor of which
// only what changes is made again.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/graph/large/clique_tree.h"
#include "server/graph/solve/gauss_newton.h"
#include "server/graph/solve/linearize.h"
#include "server/graph/solve/solve.h"

namespace rigcal::graph {

// What an update cost.
struct UpdateWork {
  int iterations = 0;        // steps taken
  int edges_evaluated = 0;   // residuals with their gradients
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
};

class LiveSolver {
 public:
  // Without edges: only the reference has a pose.
  explicit LiveSolver(const SensorId& reference, const UpdateBudget& budget = {}) : budget_(budget) {
    graph_.reference = reference;
  }
  // The state of a store: solved at once.
  explicit LiveSolver(Graph graph, const UpdateBudget& budget = {}) : budget_(budget), graph_(std::move(graph)) {
    Rebuild();
  }

  // After each of these the poses are the optimum of the cost to 1e-9 of it, or as near as the budget of a large graph
  // says. An edge may bring sensors with it; one that cannot be used is kept for the diagnoses of Solve and takes
  // no part.
  UpdateWork Add(const GraphEdge& edge);
  void AddSensor(const SensorId& sensor);
  // Nothing happens if there is no such edge.
  UpdateWork Remove(const EdgeId& edge);
  // The canonical batch solution of the edges as they are, whatever it takes; the state continues from it.
  UpdateWork Settle();
  // False once an update has stopped short of the optimum: Settle when there is time.
  [[nodiscard]] bool settled() const { return settled_; }

  // Edges and sensors as they are after the last update, also those that take no part.
  [[nodiscard]] const Graph& graph() const { return graph_; }
  // sum e^T Omega e at the poses at hand, and these poses (none for a sensor that is not connected).
  [[nodiscard]] double Cost() const { return fast_ ? graph::Cost(*problem_, T_ref_) : solution_.cost; }
  [[nodiscard]] std::optional<Se3> PoseOf(const SensorId& sensor) const;
  // What can be said at once: poses, cost, degrees of freedom, mean squares before and after; no diagnoses.
  [[nodiscard]] GraphSolution Glance() const;
  // Of the sensors connected to the reference, by name (the reference's is zero). Empty where Solve gives none.
  [[nodiscard]] std::vector<std::pair<SensorId, Matrix6d>> Marginals() const;

 private:
  UpdateWork Rebuild(UpdateWork work = {});
  [[nodiscard]] bool AdoptSolution(bool stopped);
  [[nodiscard]] int VertexOf(const SensorId& sensor) const;
  int AddVertex(const SensorId& sensor, const Se3& T_ref_sensor, int level);
  int SlotOf(int i, int j);
  void Place(const GraphEdge& edge, Constraint& constraint);
  bool Connect(const GraphEdge& edge, Constraint& constraint);
  [[nodiscard]] bool large() const { return problem_->vertex_count > budget_.sensors_exact_max; }
  [[nodiscard]] bool deep() const;
  bool FactorNow(UpdateWork& work);
  void SolveStep(Eigen::VectorXd& x, UpdateWork& work);
  bool Relax(const Constraint& added, UpdateWork& work);
  bool Descend(UpdateWork& work);
  void LeaveRest(double rest_ratio, UpdateWork& work);
  bool RelaxDeep(const Constraint& added, UpdateWork& work);
  bool DescendDeep(UpdateWork& work);
  [[nodiscard]] bool ConnectedWithout(std::size_t edge) const;
  [[nodiscard]] bool MayLeaveBasin(const Constraint& constraint) const;
  void Forget(std::size_t edge);
  [[nodiscard]] Se3 RelativePose(const Constraint& constraint) const;
  void Count(UpdateWork& work);
  void FindHanging();
  [[nodiscard]] Se3 Hanging(int vertex, const Poses& T_ref) const;
  void TakePart(int vertex);
  void TakeEdge(std::size_t edge);
  bool BeginDeep(UpdateWork& work);
  [[nodiscard]] bool IsBent(std::size_t edge, double part) const;
  bool Straighten(double part, UpdateWork& work);
  bool RenewDeep(UpdateWork& work);
  [[nodiscard]] bool Hangs(std::size_t edge) const;
  bool RenewGradientDeep(UpdateWork& work);
  bool JoinDeep(const Constraint& added, UpdateWork& work);
  bool StepDeep(UpdateWork& work);
  void GrowLeaf();

  UpdateBudget budget_;
  Graph graph_;
  bool fast_ = true;        // the state below holds; otherwise solution_ does
  GraphSolution solution_;  // of the last Rebuild
  std::unordered_map<std::string, int> vertex_of_sensor_;
  std::vector<SensorId> sensor_of_vertex_;
  std::vector<int> level_;  // of a vertex: edges from the reference when it came
  int level_max_ = 0;
  std::unordered_map<std::int64_t, int> slot_of_pair_;
  std::unique_ptr<Problem> problem_ = std::make_unique<Problem>();  // where solver_ reads it; vertices in order of
                                                                    // arrival; constraints and pattern only
  Poses T_ref_, trial_;
  std::vector<EdgeId> id_of_constraint_;
  NormalEquations equations_;
  std::unique_ptr<BlockCholesky<6>> solver_;
  int factored_count_ = 0;  // blocks of the factor at hand
  int dirty_from_ = 0;      // first block column of H that the factor does not know
  bool stale_ = true;       // H is to be linearised anew
  SecantPairs secants_;
  Eigen::VectorXd step_, g_before_;
  CliqueTree tree_;                 // of a deep graph,
  bool tree_holds_ = false;         // if it is of this graph
  std::vector<int> hangs_on_;       // of a vertex: the one edge that holds it; -1: it takes part
  std::vector<Se3> linearized_at_;  // T_i_j of every constraint as tree_ knows it
  double products_counted_ = 0.0;   // of tree_,
  int columns_counted_ = 0;
  bool settled_ = true;
};

}  // namespace rigcal::graph
