// The tree of cliques against a dense matrix: whatever came when, its solves are those of H.
#include "server/graph/large/clique_tree.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>
#include <random>

namespace rigcal::graph {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();

Matrix6d NearIdentity(std::mt19937& random) {
  std::normal_distribution<double> normal(0.0, 0.1);
  Matrix6d matrix = Matrix6d::Identity();
  for (double& entry : matrix.reshaped()) entry += normal(random);
  return matrix;
}

// Edges as they are, and the matrix they add up to.
class Twin {
 public:
  explicit Twin(unsigned seed) : random_(seed) {}

  CliqueTree::Edge Random(int i, int j) { return {i, j, -NearIdentity(random_), NearIdentity(random_)}; }
  void Take(int i, int j) {
    edges_.push_back(Random(i, j));
    renewed_.insert(renewed_.end(), {i, j});
    tree.Take(edges_.size() - 1, edges_.back());
  }
  void Change(std::size_t number) {
    changed_.push_back(number);
    renewed_.insert(renewed_.end(), {edges_[number].i, edges_[number].j});
    tree.Change(number);
  }
  // Unless H would not be definite without it.
  bool Drop(std::size_t number) {
    std::vector<CliqueTree::Edge> rest = edges_;
    rest[number] = rest.back();
    rest.pop_back();
    const Eigen::MatrixXd H = Sum(rest);
    if (!changed_.empty() || H.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() < 1e-3) return false;
    renewed_.insert(renewed_.end(), {edges_[number].i, edges_[number].j});
    tree.Drop(number, edges_.size() - 1);
    edges_ = rest;
    return true;
  }
  // All edges that are open become others.
  void Renew(int near_i, int near_j) {
    const std::vector<int> open = tree.Open();
    for (const std::size_t number : changed_)
      EXPECT_NE(std::find(open.begin(), open.end(), static_cast<int>(number)), open.end());
    changed_.clear();
    for (const int number : open) {
      CliqueTree::Edge& edge = edges_[static_cast<std::size_t>(number)];
      edge = Random(edge.i, edge.j);
      tree.Replace(static_cast<std::size_t>(number), edge);
    }
    ASSERT_TRUE(tree.Renew(near_i, near_j, kAll));
  }

  // Where x changes at blocks of new and changed edges only, and in all.
  void ExpectSolves(int step) {
    const int count = tree.block_count();
    const Eigen::MatrixXd H = Sum(edges_);
    x_.conservativeResizeLike(Eigen::VectorXd::Zero(6 * count));
    for (const int block : renewed_)
      if (block >= 0) x_.segment<6>(6 * block).setRandom();
    renewed_.clear();
    if (step % 3 == 0) {
      x_.setRandom();
      tree.TouchAll();
    }
    const Eigen::VectorXd expected = H.ldlt().solve(x_);
    EXPECT_NEAR(tree.Reduce(x_), x_.dot(expected), 1e-9 * x_.dot(expected)) << step;
    Eigen::VectorXd solved(6 * count);
    tree.Finish(solved);
    EXPECT_LE((solved - expected).norm(), 1e-9 * expected.norm()) << step;
  }

  [[nodiscard]] std::size_t edge_count() const { return edges_.size(); }
  CliqueTree tree;

 private:
  [[nodiscard]] Eigen::MatrixXd Sum(const std::vector<CliqueTree::Edge>& edges) const {
    const int count = tree.block_count();
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6 * count, 6 * count);
    for (const CliqueTree::Edge& edge : edges) {
      Eigen::MatrixXd U = Eigen::MatrixXd::Zero(6 * count, 6);
      if (edge.i >= 0) U.middleRows<6>(6 * edge.i) += edge.U_i;
      if (edge.j >= 0) U.middleRows<6>(6 * edge.j) += edge.U_j;
      H += U * U.transpose();
    }
    return H;
  }

  std::mt19937 random_;
  std::vector<CliqueTree::Edge> edges_;
  std::vector<std::size_t> changed_;
  std::vector<int> renewed_;  // blocks, since x changed last
  Eigen::VectorXd x_;
};

TEST(CliqueTree, SolvesWhateverCameWhen) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    Twin twin(seed);
    std::mt19937 random(seed + 100);
    twin.Take(-1, 0);
    int dropped = 0;
    for (int step = 0; step < 120; ++step) {
      const int count = twin.tree.block_count();
      const auto any = [&random, count] { return std::uniform_int_distribution<int>(-1, count - 1)(random); };
      const auto any_edge = [&random, &twin] { return random() % twin.edge_count(); };
      const int kind = std::uniform_int_distribution<int>(0, 11)(random);
      if (kind < 4) twin.Take(any(), count);
      if (kind >= 4 && kind < 7) {
        const int a = any(), b = any();
        if (a != b) twin.Take(a, b);
      }
      if (kind == 7) twin.Change(any_edge());
      if (kind > 9) dropped += twin.Drop(any_edge()) ? 1 : 0;
      if (kind < 6) continue;
      twin.Renew(any(), any());
      twin.ExpectSolves(step);
    }
    EXPECT_GT(dropped, 3);
  }
}

}  // namespace
}  // namespace rigcal::graph
