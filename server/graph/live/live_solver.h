// The live graph of one robot, kept at the optimum while edges come and go. It remembers poses, H and its factor
// between updates, so that an edge costs a few passes over the residuals. One thread.
//
// Small graphs have a dense factor, shallow ones are solved by conjugate gradients (`shallow_descent.h`), deep ones
// have a factor of which only what changes is made again (`deep_descent.h`).
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/graph/live/deep_descent.h"
#include "server/graph/live/live_state.h"
#include "server/graph/live/shallow_descent.h"
#include "server/graph/solve/solve.h"

namespace rigcal::graph {

// A state and what is known of its factors, either of which may be stale.
struct LiveNumbers {
  LiveState state;
  ShallowFactor shallow;
  DeepFactor deep;
};

class LiveSolver {
 public:
  // Without edges: only the reference has a pose.
  explicit LiveSolver(const SensorId& reference, const UpdateBudget& budget = {}) : budget_(budget) {
    graph_.reference = reference;
  }
  // The state of a store: solved at once.
  explicit LiveSolver(Graph graph, const UpdateBudget& budget = {}) : budget_(budget), graph_(std::move(graph)) {
    Rebuild(budget_);
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
  // The pose at hand: none for a sensor that is not connected.
  [[nodiscard]] std::optional<Se3> PoseOf(const SensorId& sensor) const;
  // What can be said at once: poses, cost = sum e^T Omega e at them, degrees of freedom, mean squares before and after;
  // no diagnoses.
  [[nodiscard]] GraphSolution Snapshot() const;
  // Of the sensors connected to the reference, by name (the reference's is zero). Empty where Solve gives none.
  [[nodiscard]] std::vector<std::pair<SensorId, Matrix6d>> Marginals() const;

 private:
  UpdateWork Rebuild(const UpdateBudget& budget, UpdateWork work = {});

  UpdateBudget budget_;
  Graph graph_;
  GraphSolution solution_;  // of the last batch: what holds where the state is not complete
  std::unique_ptr<LiveNumbers> numbers_ = std::make_unique<LiveNumbers>();  // where factors read the state
  bool settled_ = true;
};

}  // namespace rigcal::graph
