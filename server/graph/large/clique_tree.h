// A Cholesky factor of H as a tree of cliques, in which only what changes is made again: the cliques that a changed
// edge touches, and those between them and the root (the Bayes tree of Kaess et al., iSAM2, IJRR 2012). Everything that
// hangs below keeps its columns of the factor and what it leaves to its parent; the part made again gets a new order,
// in which the places that change now come last, for they are where the next changes will be.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/graph/large/block_matrix.h"
#include "server/math/tangent.h"

namespace rigcal::graph {

class CliqueTree {
 public:
  // What one edge adds to H: U U^T with these rows of U at two blocks (-1: fixed).
  struct Edge {
    int i = -1, j = -1;
    Matrix6d U_i, U_j;
  };

  // As if made anew: no edges, no blocks, and the counts below at zero.
  void Clear();
  // An edge under its number, and blocks that have none yet. The factor knows it after Renew.
  void Take(std::size_t number, const Edge& edge);
  // This edge is to be another: its part of the factor will open.
  void Change(std::size_t number);
  // This edge is no more, and the one of the largest number takes its number. Its blocks keep other edges.
  void Drop(std::size_t number, std::size_t largest);
  // Another linearisation of an edge whose part of the factor is open, between the same blocks.
  void Replace(std::size_t number, const Edge& edge);
  // Two steps bring the factor up to date. Open gives the edges whose part of the factor is made again, whatever they
  // are: to linearise them anew by Replace costs nothing more.
  [[nodiscard]] std::vector<int> Open();
  // `near`: two blocks by which the next changes are expected. False if it takes more than `products_max` products of
  // blocks or the memory limit of MakeCholesky, or if H is not positive definite: then Clear.
  [[nodiscard]] bool Renew(int near_i, int near_j, double products_max);

  // The two halves of x <- H^-1 x; zero at blocks without edges. The first gives x^T H^-1 x, which is enough to know
  // what a step would gain, and goes only where the factor was renewed since it came last: x may be another at blocks
  // of edges that are new or changed. TouchAll: x is another everywhere.
  void TouchAll();
  [[nodiscard]] double Reduce(const Eigen::VectorXd& x);
  void Finish(Eigen::VectorXd& x);

  // Blocks that have been taken, with edges or without any more.
  [[nodiscard]] int block_count() const { return static_cast<int>(owner_.size()); }
  // Of all calls since Clear: products of blocks, and columns renewed.
  [[nodiscard]] double products() const { return products_; }
  [[nodiscard]] int columns() const { return columns_; }

 private:
  struct Clique {
    std::vector<int> blocks;  // its own, then those it hangs on: all owned by cliques above
    int own_count = 0;
    int parent = -1;
    std::vector<int> children;
    Eigen::MatrixXd L;          // its columns of the factor: rows of `blocks`
    Eigen::MatrixXd left;       // what its subtree leaves to the blocks it hangs on: lower triangle; empty: nothing
    Eigen::VectorXd y, passed;  // of the solve at hand: own rows of L^-1 x; what the subtree passes up
    double gain = 0.0;          // |y|^2
    bool stale = true;          // y, passed, gain
    bool open = false;          // to be made again

    [[nodiscard]] int below_count() const { return static_cast<int>(blocks.size()) - own_count; }
  };
  // The part that is made again.
  struct Part {
    std::vector<int> blocks;   // ascending
    std::vector<int> opened;   // cliques that it replaces
    std::vector<int> orphans;  // cliques that hang on it
    Supernodes shape;
    std::vector<int> block_at;  // by place in the new order
    double products = 0.0;
  };

  void Reserve(int block);
  void OpenAbove(int block);
  [[nodiscard]] std::vector<bool> Near(const BlockPattern& pattern, int near_i, int near_j) const;
  void Arrange(int near_i, int near_j);
  [[nodiscard]] BlockPattern Pattern() const;
  std::vector<int> Install();
  void Adopt(const std::vector<int>& made);
  [[nodiscard]] bool Factor(Clique& clique);
  void AddEdges(const Clique& clique, Eigen::Map<Eigen::MatrixXd>& front);
  void AddLeft(const Clique& child, Eigen::Map<Eigen::MatrixXd>& front);
  void Forward(Clique& clique, const Eigen::VectorXd& x);

  std::vector<Edge> edges_;
  std::vector<std::vector<int>> edges_of_block_;
  std::vector<int> owner_;  // clique of a block; -1: none yet
  std::vector<Clique> cliques_;
  std::vector<int> vacant_;   // places in cliques_
  std::vector<int> order_;    // cliques, parents first
  std::vector<int> touched_;  // blocks of edges that the factor does not know yet
  Part part_;
  std::vector<int> place_;  // scratch by block: -1 between calls
  std::vector<int> rank_;   // scratch by block: place in the new order; -1 between calls
  std::vector<double> front_;
  Eigen::VectorXd above_, step_;
  double products_ = 0.0;
  int columns_ = 0;
};

}  // namespace rigcal::graph
