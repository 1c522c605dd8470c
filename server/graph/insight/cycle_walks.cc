#include "server/graph/insight/cycle_walks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/math/covariance.h"
#include "server/model/approval/policy.h"

namespace rigcal::graph {
namespace {

constexpr std::size_t kLooksPerStep = 100;  // at edges that may close a triangle: far cheaper than a step

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
  std::vector<int> roughness;       // likewise

  [[nodiscard]] int DepthOf(int vertex) const { return depth[static_cast<std::size_t>(vertex)]; }
};

int OtherEnd(const Constraint& c, std::size_t vertex) { return static_cast<std::size_t>(c.i) == vertex ? c.j : c.i; }

// How far beyond the default tolerance the worst axis of a measurement is, in powers of two; 0: it is not. One that
// leaves directions open is rougher than all others.
int RoughnessOf(const Constraint& c) {
  constexpr int kRoughest = 20;
  if (c.rank < 6) return kRoughest + 1;
  const Vector6d sigma = Observable(c.Omega).covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const double times =
      std::max(sigma.head<3>().maxCoeff() / kDefaultTolerance.m, sigma.tail<3>().maxCoeff() / kDefaultTolerance.rad);
  if (!(times > 1.0)) return 0;
  return static_cast<int>(std::min(std::ceil(std::log2(times)), static_cast<double>(kRoughest)));
}

// The edges of a spanning tree, level of roughness by level: those of each join what surer ones left apart.
class SurestTree {
 public:
  SurestTree(const Problem& problem, const ConstraintsOf& at)
      : problem_(problem), at_(at), joined_(at.size()), in_tree_(problem.constraints.size(), false) {
    for (const Constraint& c : problem.constraints) roughness_.push_back(RoughnessOf(c));
  }

  std::vector<bool> Take() {
    for (const int level : std::set<int>(roughness_.begin(), roughness_.end())) {
      std::vector<bool> seen(at_.size(), false);
      for (std::size_t vertex = 0; vertex < at_.size(); ++vertex)
        if (!seen[vertex]) JoinFrom(vertex, level, seen);
    }
    return std::move(in_tree_);
  }
  [[nodiscard]] const std::vector<int>& roughness() const { return roughness_; }

 private:
  // Breadth first over edges that are not rougher.
  void JoinFrom(std::size_t root, int level, std::vector<bool>& seen) {
    std::vector<std::size_t> queue = {root};
    seen[root] = true;
    for (std::size_t n = 0; n < queue.size(); ++n)
      for (const std::size_t k : at_[queue[n]]) {
        if (roughness_[k] > level) continue;
        const Constraint& c = problem_.constraints[k];
        if (joined_.Join(c.i, c.j)) in_tree_[k] = true;
        const auto other = static_cast<std::size_t>(OtherEnd(c, queue[n]));
        if (!seen[other]) queue.push_back(other);
        seen[other] = true;
      }
  }

  const Problem& problem_;
  const ConstraintsOf& at_;
  std::vector<int> roughness_;  // by constraint
  UnionFind joined_;
  std::vector<bool> in_tree_;
};

// Rooted at the reference.
Tree GrowTree(const Problem& problem, const ConstraintsOf& at) {
  const auto count = static_cast<std::size_t>(problem.vertex_count);
  SurestTree surest(problem, at);
  Tree tree{std::vector<int>(count, -1), std::vector<WalkStep>(count), surest.Take(), surest.roughness()};
  std::vector<std::size_t> queue = {0};
  tree.depth[0] = 0;
  for (std::size_t n = 0; n < queue.size(); ++n)
    for (const std::size_t k : at[queue[n]]) {
      const Constraint& c = problem.constraints[k];
      const auto other = static_cast<std::size_t>(OtherEnd(c, queue[n]));
      if (!tree.in_tree[k] || tree.depth[other] >= 0) continue;
      tree.depth[other] = tree.depth[queue[n]] + 1;
      tree.to_parent[other] = {k, static_cast<std::size_t>(c.j) == queue[n]};
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

// Loops of sure edges first, of these the short ones; `steps_max` steps in all, half of them for triangles where there
// are so many.
class Collector {
 public:
  Collector(const Problem& problem, std::size_t steps_max)
      : problem_(problem),
        at_(ConstraintsAt(problem)),
        steps_left_(steps_max),
        looks_left_(kLooksPerStep * steps_max) {}

  CycleWalks Take() {
    const Tree tree = GrowTree(problem_, at_);
    const std::vector<std::size_t> chords = ChordsOf(tree);
    const std::size_t of_triangles = steps_left_ / 2;
    std::size_t n = AddLoops(tree, chords, 0, of_triangles);
    for (std::size_t k = 0; k < problem_.constraints.size() && found_.complete; ++k) AddTriangles(k);
    n = AddLoops(tree, chords, n, 0);
    found_.complete &= n == chords.size();
    return std::move(found_);
  }

 private:
  // False: there is no room for it.
  bool Add(Walk walk, std::size_t reserved) {
    if (walk.size() + reserved > steps_left_) return false;
    std::vector<std::size_t> key;
    for (const WalkStep& step : walk) key.push_back(step.constraint);
    std::sort(key.begin(), key.end());
    if (!seen_.insert(std::move(key)).second) return true;
    steps_left_ -= walk.size();
    found_.walks.push_back(std::move(walk));
    return true;
  }

  [[nodiscard]] std::vector<std::size_t> ChordsOf(const Tree& tree) const {
    const auto rank = [&](std::size_t k) {
      const Constraint& c = problem_.constraints[k];
      return std::pair(tree.roughness[k], tree.DepthOf(c.i) + tree.DepthOf(c.j));
    };
    std::vector<std::size_t> chords;
    for (std::size_t k = 0; k < problem_.constraints.size(); ++k)
      if (!tree.in_tree[k]) chords.push_back(k);
    std::stable_sort(chords.begin(), chords.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    return chords;
  }

  // From the n-th chord on; the first that has no room beside what is reserved.
  std::size_t AddLoops(const Tree& tree, const std::vector<std::size_t>& chords, std::size_t n, std::size_t reserved) {
    while (n < chords.size() && Add(LoopOf(problem_, tree, chords[n]), reserved)) ++n;
    return n;
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
          found_.complete &= Add({{first, true}, StepFrom(problem_, second, j), StepFrom(problem_, third, k)}, 0);
    }
  }

  const Problem& problem_;
  const ConstraintsOf at_;
  std::size_t steps_left_, looks_left_;
  std::set<std::vector<std::size_t>> seen_;
  CycleWalks found_;
};

}  // namespace

int StartOf(const Problem& problem, const WalkStep& step) {
  const Constraint& c = problem.constraints[step.constraint];
  return step.forward ? c.i : c.j;
}

CycleWalks WalksOf(const Problem& problem, std::size_t steps_max) {
  return problem.vertex_count == 0 ? CycleWalks() : Collector(problem, steps_max).Take();
}

}  // namespace rigcal::graph
