// A sparse Cholesky factor of H that takes new vertices and new edges without being made again. A new vertex hangs on
// one edge: eliminated before its neighbour it changes nothing else, so it is one more column in front. A new edge is a
// correction of rank six, H + U U^T (or - where an edge is linearised anew), held beside the factor (Woodbury): it
// touches the columns between its ends and the root of the elimination tree, no others.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "server/graph/block_kernels.h"
#include "server/graph/block_matrix.h"
#include "server/graph/sparse_cholesky.h"
#include "server/math/tangent.h"

namespace rigcal::graph {

class GrowingFactor {
 public:
  // A factor of H, whose off-diagonal blocks may stand in any order. False if it would take more than `products_max`
  // products of blocks (beyond the memory limit of MakeCholesky: always), or if H is not positive definite.
  [[nodiscard]] bool Renew(const BlockPattern& pattern, const BlockMatrix<6>& H, double products_max);
  // The next block, bound to `parent` (-1: to what is fixed) by H(v, v) and H(parent, v). False if H(v, v) is not
  // positive definite.
  [[nodiscard]] bool AddLeaf(int parent, const Matrix6d& H_leaf, const Matrix6d& H_parent_leaf);
  // H + sign U U^T with U_i, U_j at the rows of the blocks i, j (-1: not there); what is taken away (sign -1) must be
  // in H. How many block columns that took; -1 if H is not positive definite any more: then it is to be renewed.
  [[nodiscard]] int AddEdge(double sign, int i, const Matrix6d& U_i, int j, const Matrix6d& U_j);

  // The two halves of x <- H^-1 x; the first gives x^T H^-1 x, which is enough to know what a step would gain.
  [[nodiscard]] double Reduce(const Eigen::VectorXd& x);
  void Finish(Eigen::VectorXd& x);

  [[nodiscard]] int corrections() const { return static_cast<int>(corrections_.size()); }
  // Products of blocks: in making the factor, in one solve.
  [[nodiscard]] double products_of_factor() const { return products_of_factor_; }
  [[nodiscard]] double products_of_solve() const { return products_of_solve_; }

 private:
  struct Leaf {
    int parent = -1;
    Matrix6d L, B;  // own factor (FactorBlock); H(parent, leaf) L^-T
  };
  struct Rows {
    int first = 0, count = 0;
  };
  struct Correction {
    double sign = 1.0;
    std::vector<Rows> rows;
    Eigen::MatrixXd W;  // L^-1 U at these rows
  };

  void MarkPath(int block);
  void ReducePath();
  void KeepPath(Correction& correction);
  [[nodiscard]] bool Extend(const Correction& added);

  int base_count_ = 0;  // blocks of base_; the others are leaves
  std::unique_ptr<SparseCholesky<6>> base_;
  std::vector<int> row_of_block_;  // first row in the order of elimination: base_'s, then the leaves
  std::vector<int> parent_of_supernode_;
  std::vector<Leaf> leaves_;
  std::vector<Correction> corrections_;
  Eigen::MatrixXd S_;                  // M of M D M^T = D + W^T W, in its leading rows
  Eigen::VectorXd y_, w_, below_;      // of the solve at hand
  Eigen::MatrixXd wide_, wide_below_;  // six columns at once; wide_ is zero between calls
  std::vector<bool> on_path_of_leaf_, on_path_of_supernode_;
  std::vector<int> path_leaves_, path_supernodes_;
  double products_of_factor_ = 0.0, products_of_solve_ = 0.0;
};

}  // namespace rigcal::graph
