#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "server/graph/insight/insight.h"
#include "server/graph/uncertainty/graph_jackknife.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

constexpr std::size_t kLooksPerStep = 100;  // at edges that may close a triangle: far cheaper than a step

constexpr double kDofMax = 1e6, kDofRounding = 1e-6;
constexpr double kProbability = 0.999;  // that all cycles of a graph of good edges close

// Which loops of edges a graph has: the loop of every edge outside a spanning tree of fewest hops, then triangles.
struct WalkStep {
  std::size_t constraint = 0;
  bool forward = true;  // from i to j
};
using Walk = std::vector<WalkStep>;

struct CycleWalks {
  std::vector<Walk> walks;  // no two of the same edges
  bool complete = true;     // false: longer loops, or triangles, were left out
};

// The vertex at which a step starts, and where it ends.
int StartOf(const Problem& problem, const WalkStep& step) {
  const Constraint& c = problem.constraints[step.constraint];
  return step.forward ? c.i : c.j;
}

int EndOf(const Problem& problem, const WalkStep& step) {
  const Constraint& c = problem.constraints[step.constraint];
  return step.forward ? c.j : c.i;
}

using ConstraintsOf = std::vector<std::vector<std::size_t>>;  // by vertex

ConstraintsOf ConstraintsAt(const Problem& problem) {
  ConstraintsOf at(static_cast<std::size_t>(problem.vertex_count));
  for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
    at[static_cast<std::size_t>(problem.constraints[k].i)].push_back(k);
    at[static_cast<std::size_t>(problem.constraints[k].j)].push_back(k);
  }
  return at;
}

struct Tree {
  std::vector<int> depth;           // by vertex
  std::vector<WalkStep> to_parent;  // the step from a vertex to its parent
  std::vector<bool> in_tree;        // by constraint

  [[nodiscard]] int DepthOf(int vertex) const { return depth[static_cast<std::size_t>(vertex)]; }
};

Tree GrowBreadthFirst(const Problem& problem, const ConstraintsOf& at) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  Tree tree{std::vector<int>(count, -1), std::vector<WalkStep>(count),
            std::vector<bool>(problem.constraints.size(), false)};
  std::vector<std::size_t> queue = {0};
  tree.depth[0] = 0;
  for (std::size_t n = 0; n < queue.size(); ++n)
    for (const std::size_t k : at[queue[n]]) {
      const Constraint& c = problem.constraints[k];
      const bool is_i = static_cast<std::size_t>(c.i) == queue[n];
      const auto other = static_cast<std::size_t>(is_i ? c.j : c.i);
      if (tree.depth[other] >= 0) continue;
      tree.depth[other] = tree.depth[queue[n]] + 1;
      tree.to_parent[other] = {k, !is_i};
      tree.in_tree[k] = true;
      queue.push_back(other);
    }
  return tree;
}

// From i over the edge to j, up to the common ancestor and down again to i.
Walk LoopOf(const Problem& problem, const Tree& tree, std::size_t chord) {
  Walk walk = {{chord, true}}, down;
  int a = problem.constraints[chord].j, b = problem.constraints[chord].i;
  while (a != b) {
    int& deeper = tree.DepthOf(a) >= tree.DepthOf(b) ? a : b;
    const WalkStep step = tree.to_parent[static_cast<std::size_t>(deeper)];
    if (&deeper == &a) {
      walk.push_back(step);
    } else {
      down.push_back({step.constraint, !step.forward});
    }
    deeper = EndOf(problem, step);
  }
  walk.insert(walk.end(), down.rbegin(), down.rend());
  return walk;
}

WalkStep StepFrom(const Problem& problem, std::size_t constraint, int vertex) {
  return {constraint, problem.constraints[constraint].i == vertex};
}

// Short loops first, `steps_max` steps in all.
class Collector {
 public:
  Collector(const Problem& problem, std::size_t steps_max)
      : problem_(problem),
        at_(ConstraintsAt(problem)),
        steps_left_(steps_max),
        looks_left_(kLooksPerStep * steps_max) {}

  CycleWalks Take() {
    AddLoops();
    for (std::size_t k = 0; k < problem_.constraints.size() && found_.complete; ++k) AddTriangles(k);
    return std::move(found_);
  }

 private:
  void Add(Walk walk) {
    if (walk.size() > steps_left_) {
      found_.complete = false;
      return;
    }
    std::vector<std::size_t> key;
    for (const WalkStep& step : walk) key.push_back(step.constraint);
    std::sort(key.begin(), key.end());
    if (!seen_.insert(std::move(key)).second) return;
    steps_left_ -= walk.size();
    found_.walks.push_back(std::move(walk));
  }

  void AddLoops() {
    const Tree tree = GrowBreadthFirst(problem_, at_);
    const auto climb = [&](std::size_t k) {
      return tree.DepthOf(problem_.constraints[k].i) + tree.DepthOf(problem_.constraints[k].j);
    };
    std::vector<std::size_t> chords;
    for (std::size_t k = 0; k < problem_.constraints.size(); ++k)
      if (!tree.in_tree[k]) chords.push_back(k);
    std::stable_sort(chords.begin(), chords.end(), [&](std::size_t a, std::size_t b) { return climb(a) < climb(b); });
    for (std::size_t n = 0; n < chords.size() && found_.complete; ++n) Add(LoopOf(problem_, tree, chords[n]));
  }

  // Triangles whose first edge has the smallest number.
  void AddTriangles(std::size_t first) {
    const int i = problem_.constraints[first].i, j = problem_.constraints[first].j;
    for (const std::size_t second : at_[static_cast<std::size_t>(j)]) {
      const int k = EndOf(problem_, StepFrom(problem_, second, j));
      if (second <= first || k == i || k == j) continue;
      const auto& at_k = at_[static_cast<std::size_t>(k)];
      if (at_k.size() > looks_left_) found_.complete = false;
      if (!found_.complete) return;
      looks_left_ -= at_k.size();
      for (const std::size_t third : at_k)
        if (third > first && third != second && EndOf(problem_, StepFrom(problem_, third, k)) == i)
          Add({{first, true}, StepFrom(problem_, second, j), StepFrom(problem_, third, k)});
    }
  }

  const Problem& problem_;
  const ConstraintsOf at_;
  std::size_t steps_left_, looks_left_;
  std::set<std::vector<std::size_t>> seen_;
  CycleWalks found_;
};

// What one edge errs by, column by column, and which cause each part belongs to.
struct Causes {
  struct Part {
    std::size_t source = 0;
    int dof = 0;
    MatrixXd d;  // right tangent of the measurement
  };
  std::vector<std::vector<Part>> of_constraint;
  std::vector<bool> own_known;  // by constraint
  std::size_t shared_count = 0;
};

class Judge {
 public:
  Judge(const Graph& graph, const Problem& problem, const BlocksByEdge& blocks)
      : work_{graph, problem, blocks, {}}, covariance_(problem.constraints.size()) {
    work_.jacobians.resize(problem.constraints.size());
    for (EdgeJacobian& jacobian : work_.jacobians) jacobian.D = Matrix6d::Identity();  // causes as the edges have them
    TakeShared();
  }

  CycleResidual Residual(const Walk& walk) {
    CycleResidual cycle;
    cycle.tested = true;
    for (const WalkStep& step : walk) {
      cycle.edges.push_back(work_.EdgeOf(step.constraint).id);
      cycle.sensors.push_back(SensorAt(StartOf(work_.problem, step)));
      cycle.tested = cycle.tested && work_.problem.constraints[step.constraint].rank == 6;
    }
    const std::vector<Matrix6d> carry = Carry(walk, cycle.e);
    if (cycle.tested) Test(walk, carry, cycle);
    return cycle;
  }

 private:
  void TakeShared() {
    causes_.of_constraint.resize(work_.problem.constraints.size());
    causes_.own_known.assign(work_.problem.constraints.size(), false);
    std::vector<ErrorSource> shared = SharedSourcesOf(work_);
    causes_.shared_count = shared.size();
    for (std::size_t s = 0; s < shared.size(); ++s)
      for (ErrorPart& part : shared[s].parts)
        causes_.of_constraint[part.constraint].push_back({s, shared[s].dof, std::move(part.de)});
  }

  const std::vector<Causes::Part>& CausesOf(std::size_t k) {
    if (!causes_.own_known[k]) {
      ErrorSource own = OwnSourceOf(work_, k);
      if (own.column_count > 0)
        causes_.of_constraint[k].push_back({causes_.shared_count + k, own.dof, std::move(own.parts[0].de)});
      covariance_[k] = Observable(work_.problem.constraints[k].Omega).covariance;
      causes_.own_known[k] = true;
    }
    return causes_.of_constraint[k];
  }

  [[nodiscard]] const SensorId& SensorAt(int vertex) const {
    return work_.graph.sensors[work_.problem.sensor_of_vertex[static_cast<std::size_t>(vertex)]];
  }

  // What an error of each step's measurement does to the loop's residual. (The residual's own Jacobian leaves e and
  // thereby T^2 as they are.)
  std::vector<Matrix6d> Carry(const Walk& walk, Vector6d& e) const {
    std::vector<Matrix6d> carry(walk.size());
    Se3 T_after;  // of the steps behind this one
    for (std::size_t n = walk.size(); n-- > 0;) {
      const Constraint& c = work_.problem.constraints[walk[n].constraint];
      const Matrix6d A = Adjoint(T_after.Inverse());
      carry[n] = walk[n].forward ? A : Matrix6d(-A * Adjoint(c.T_i_j));
      T_after = ((walk[n].forward ? c.T_i_j : c.T_j_i) * T_after).Normalized();
    }
    e = T_after.Log();
    return carry;
  }

  void Test(const Walk& walk, const std::vector<Matrix6d>& carry, CycleResidual& cycle) {
    std::vector<Causes::Part> sums;  // per cause: what it does to the loop
    Matrix6d C_independent = Matrix6d::Zero();
    for (std::size_t n = 0; n < walk.size(); ++n) {
      for (const Causes::Part& part : CausesOf(walk[n].constraint)) {
        const auto same =
            std::find_if(sums.begin(), sums.end(), [&](const Causes::Part& sum) { return sum.source == part.source; });
        if (same == sums.end()) {
          sums.push_back({part.source, part.dof, carry[n] * part.d});
        } else {
          same->d += carry[n] * part.d;
        }
      }
      C_independent += carry[n] * covariance_[walk[n].constraint] * carry[n].transpose();
    }
    Compare(Symmetrized(C_independent), sums, cycle);
  }

  void Compare(const Matrix6d& C_independent, const std::vector<Causes::Part>& sums, CycleResidual& cycle) const {
    const Eigen::LLT<Matrix6d> whiten(C_independent);
    cycle.tested = whiten.info() == Eigen::Success;
    if (!cycle.tested) return;
    const Vector6d e = whiten.matrixL().solve(cycle.e);
    Matrix6d C = Matrix6d::Zero();
    double trace = 0.0, dof_sum = 0.0;
    for (const Causes::Part& sum : sums) {
      const MatrixXd white = whiten.matrixL().solve(sum.d);
      C += white * white.transpose();
      trace += white.squaredNorm();
      if (sum.dof > 0) dof_sum += white.squaredNorm() * white.squaredNorm() / sum.dof;
    }
    cycle.dof = dof_sum > 0.0 ? trace * trace / dof_sum : 0.0;
    const bool shared = std::any_of(sums.begin(), sums.end(),
                                    [&](const Causes::Part& sum) { return sum.source < causes_.shared_count; });
    const CheckedDirections checked =
        shared ? CheckWhitened(C, e) : CheckedDirections{6, e.squaredNorm()};  // else C is the identity
    cycle.rank = checked.rank, cycle.t_squared = checked.t_squared;
    cycle.tested = cycle.rank > 0 && std::isfinite(cycle.t_squared);
    if (!cycle.tested) cycle.t_squared = cycle.dof = cycle.rank = 0;
  }

  JackknifeWork work_;
  Causes causes_;
  std::vector<Matrix6d> covariance_;
};

// Per cycle, so that all of them together pass with kProbability where every edge is good.
class Limits {
 public:
  explicit Limits(std::int64_t count)
      : each_(1.0 - (1.0 - kProbability) / static_cast<double>(std::max<std::int64_t>(count, 1))) {}

  double Of(const CycleResidual& cycle) {
    const int dof = cycle.dof > 0.0 ? static_cast<int>(std::min(cycle.dof, kDofMax) + kDofRounding) : -1;
    const auto [at, is_new] = known_.try_emplace({dof, cycle.rank}, 0.0);
    if (!is_new) return at->second;
    const double limit = dof < 0 ? ChiSquareQuantile(each_, cycle.rank) : HotellingLimit(dof + 1, cycle.rank, each_);
    return at->second = std::isfinite(limit) ? limit : 0.0;
  }

 private:
  double each_;
  std::map<std::pair<int, int>, double> known_;  // by degrees of freedom and rank: many cycles have the same
};

bool WorseThan(const CycleResidual& a, const CycleResidual& b) {
  const auto key = [](const CycleResidual& cycle) {
    const double ratio = cycle.limit > 0.0 ? cycle.t_squared / cycle.limit : -1.0;
    return std::make_tuple(-ratio, -cycle.e.head<3>().norm());
  };
  return key(a) != key(b) ? key(a) < key(b) : a.edges < b.edges;
}

// Many loops may fail by a hair that is beyond chance: of the `failing` first that which is most open is the last one
// kept.
void KeepMostOpen(std::size_t kept, std::int64_t failing, std::vector<CycleResidual>& cycles) {
  if (kept == 0 || failing <= static_cast<std::int64_t>(kept)) return;
  const auto openness = [](const CycleResidual& cycle) {
    return std::max(cycle.e.head<3>().norm() / kMovedMin_m, cycle.e.tail<3>().norm() / kMovedMin_rad);
  };
  const auto most = std::max_element(cycles.begin(), cycles.begin() + failing,
                                     [&](const auto& a, const auto& b) { return openness(a) < openness(b); });
  const auto last = cycles.begin() + static_cast<std::ptrdiff_t>(kept) - 1;
  if (most > last) std::iter_swap(most, last);
}

void KeepWorst(std::vector<CycleResidual>& cycles, const CycleOptions& options, Cycles& judged) {
  judged.examined = static_cast<std::int64_t>(cycles.size());
  Limits limits(std::count_if(cycles.begin(), cycles.end(), [](const auto& cycle) { return cycle.tested; }));
  for (CycleResidual& cycle : cycles) {
    if (cycle.tested) cycle.limit = limits.Of(cycle);
    judged.tested += cycle.limit > 0.0 ? 1 : 0;
    judged.failing += cycle.fails() ? 1 : 0;
  }
  std::sort(cycles.begin(), cycles.end(), WorseThan);
  KeepMostOpen(options.worst_max, judged.failing, cycles);
  cycles.resize(std::min(cycles.size(), options.worst_max));
  judged.worst = std::move(cycles);
}

}  // namespace

Cycles JudgeCycles(const Graph& graph, const BlocksByEdge& blocks, const CycleOptions& options) {
  Cycles judged;
  const Problem problem = MakeProblem(graph);
  if (!blocks.empty() && problem.free_count() >= kJackknifeSensorsMax) {
    judged.why_not = "Loops were left out: over shared captures they are worked out up to " +
                     std::to_string(kJackknifeSensorsMax) + " sensors, and this graph has " +
                     std::to_string(problem.vertex_count) + ".";
    return judged;
  }
  const CycleWalks found = problem.vertex_count == 0 ? CycleWalks() : Collector(problem, options.steps_max).Take();
  Judge judge(graph, problem, blocks);
  std::vector<CycleResidual> cycles;
  for (const Walk& walk : found.walks) cycles.push_back(judge.Residual(walk));
  judged.judged = true;
  if (!found.complete)
    judged.why_not = "Longer loops were left out: the first " + std::to_string(found.walks.size()) +
                     " were worked out, those over the fewest edges, " + std::to_string(options.steps_max) +
                     " steps in all.";
  KeepWorst(cycles, options, judged);
  return judged;
}

}  // namespace rigcal::graph
