#include "server/graph/step_solver.h"

#include <algorithm>

#include "server/graph/conjugate_gradients.h"

namespace rigcal::graph {
namespace {

constexpr int kLevelsMax = 12;
constexpr double kProductsPerLevel = 20.0;  // of H with a vector, in a whole descent, by experience

// Levels of a breadth-first search from the reference; kLevelsMax + 1 if there are more.
int CountLevels(const Problem& problem) {
  std::vector<int> level(static_cast<std::size_t>(problem.vertex_count), kLevelsMax + 1);
  level[0] = 0;
  for (int at = 1; at <= kLevelsMax; ++at) {
    bool reached = false;
    const auto reach = [&level, &reached, at](int from, int to) {
      int& other = level[static_cast<std::size_t>(to)];
      if (level[static_cast<std::size_t>(from)] != at - 1 || other <= at) return;
      other = at;
      reached = true;
    };
    for (const Constraint& c : problem.constraints) reach(c.i, c.j), reach(c.j, c.i);
    if (!reached) break;
  }
  return *std::max_element(level.begin(), level.end());
}

bool HasFullRank(const Problem& problem) {
  return std::all_of(problem.constraints.begin(), problem.constraints.end(),
                     [](const Constraint& c) { return c.rank == 6; });
}

}  // namespace

bool PrefersConjugateGradients(const Problem& problem) {
  if (problem.free_count() <= kBlocksDenseMax) return false;
  const EliminationCost& cost = problem.elimination_cost;
  if (cost.entries * 36.0 * sizeof(double) > static_cast<double>(kFactorBytesMax)) return false;
  const double product =
      static_cast<double>(problem.free_count()) + 2.0 * static_cast<double>(problem.pattern.off_diagonal.size());
  if (216.0 * cost.flops <= kProductsPerLevel * 72.0 * product) return false;
  const int levels = CountLevels(problem);
  return levels <= kLevelsMax && 216.0 * cost.flops > kProductsPerLevel * levels * 72.0 * product &&
         HasFullRank(problem);
}

std::unique_ptr<BlockCholesky<6>> MakeStepSolver(const Problem& problem) {
  if (PrefersConjugateGradients(problem)) return std::make_unique<ConjugateGradients>(problem.pattern);
  return MakeCholesky<6>(problem.pattern);
}

}  // namespace rigcal::graph
