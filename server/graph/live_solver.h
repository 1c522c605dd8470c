// The live state of one robot's graph, kept at the optimum while edges come and go. It remembers poses, H and its
// factor between updates, so that an edge costs a few passes over the residuals. One thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/graph/linearize.h"
#include "server/graph/secant_pairs.h"
#include "server/graph/solve.h"

namespace rigcal::graph {

// What an update cost.
struct UpdateWork {
  int iterations = 0;        // steps taken
  int edges_evaluated = 0;   // residuals with their gradients
  int columns_factored = 0;  // block columns of the factor that were renewed
  bool batch = false;        // solved from the ground up: a removed edge, a large step, a deficient edge, a deep graph
};

class LiveSolver {
 public:
  explicit LiveSolver(const SensorId& reference) { graph_.reference = reference; }
  // The state of a store: solved at once.
  explicit LiveSolver(Graph graph) : graph_(std::move(graph)) { Rebuild(); }

  // After each of these the poses are the optimum of the cost to 1e-9 of it. An edge may bring sensors with it; one
  // that cannot be used is kept for the diagnoses of Solution() and takes no part.
  UpdateWork Add(const GraphEdge& edge);
  UpdateWork AddSensor(const SensorId& sensor);
  // Nothing happens if there is no such edge.
  UpdateWork Remove(const EdgeId& edge);
  UpdateWork Reweight(const EdgeId& edge, const Matrix6d& Omega, int rank);
  // The canonical batch solution of the edges as they are; the state continues from it.
  UpdateWork Settle() { return Rebuild(); }

  [[nodiscard]] const Graph& graph() const { return graph_; }
  // sum e^T Omega e at the poses at hand, and these poses (none for a sensor that is not connected).
  [[nodiscard]] double Cost() const { return fast_ ? graph::Cost(*problem_, T_ref_) : solution_.cost; }
  [[nodiscard]] std::optional<Se3> PoseOf(const SensorId& sensor) const;
  // Poses, residuals and diagnoses as Solve would give them, from the poses at hand.
  [[nodiscard]] GraphSolution Solution(const SolveOptions& options = {}) const;
  // Of the sensors connected to the reference, by name (the reference's is zero). Empty where Solve gives none.
  [[nodiscard]] std::vector<std::pair<SensorId, Matrix6d>> Marginals() const;

 private:
  UpdateWork Rebuild();
  [[nodiscard]] bool AdoptSolution();
  [[nodiscard]] int VertexOf(const SensorId& sensor) const;
  int AddVertex(const SensorId& sensor, const Se3& T_ref_sensor, int level);
  void InsertSensor(const SensorId& sensor);
  int SlotOf(int i, int j);
  void Place(const GraphEdge& edge, Constraint& constraint);
  bool Connect(const GraphEdge& edge, Constraint& constraint);
  bool FactorNow(UpdateWork& work);
  bool Relax(const Constraint& added, UpdateWork& work);

  Graph graph_;
  bool fast_ = true;        // the state below holds; otherwise solution_ does
  GraphSolution solution_;  // of the last Rebuild
  std::unordered_map<std::string, int> vertex_of_sensor_;
  std::vector<SensorId> sensor_of_vertex_;
  std::vector<int> level_;  // of a vertex: edges from the reference when it came
  std::unordered_map<std::int64_t, int> slot_of_pair_;
  std::unique_ptr<Problem> problem_ = std::make_unique<Problem>();  // where solver_ reads it; vertices in order of
                                                                    // arrival; constraints and pattern only
  Poses T_ref_, trial_;
  NormalEquations equations_;
  std::unique_ptr<BlockCholesky<6>> solver_;
  int factored_count_ = 0;  // blocks of the factor at hand
  int dirty_from_ = 0;      // first block column of H that the factor does not know
  bool stale_ = true;       // H is to be linearised anew
  SecantPairs secants_;
  Eigen::VectorXd step_, g_before_;
};

}  // namespace rigcal::graph
