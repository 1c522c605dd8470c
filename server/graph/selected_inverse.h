// A supernodal Cholesky factor as plain arrays (CHOLMOD's layout): supernode s has columns [super[s], super[s+1]) and
// the rows `rows[row_start[s] .. row_start[s+1])`, the first of which are its own columns; its values are a dense
// column-major trapezoid at value_start[s], as many rows as the supernode has.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace rigcal::graph {

struct SupernodalView {
  int size = 0;
  int supernode_count = 0;
  const int* super = nullptr;
  const int* row_start = nullptr;
  const int* value_start = nullptr;
  const int* rows = nullptr;
  const double* values = nullptr;
  std::size_t value_count = 0;
};

// The entries of (L L^T)^-1 on the pattern of L (Takahashi's recursion, supernode by supernode, last to first), exact up
// to rounding, without the inverse itself.
class SelectedInverse {
 public:
  explicit SelectedInverse(const SupernodalView& L);
  // Entry (row, col) of the inverse; it must lie in the pattern of L (any entry of A does).
  [[nodiscard]] double At(int row, int col) const;

 private:
  struct Shape {
    int first_col, col_count, row_count;
    const int* rows;
    std::size_t start;
  };
  [[nodiscard]] Shape ShapeOf(int s) const;
  void InvertSupernode(int s);
  void GatherAncestors(const Shape& shape, Eigen::MatrixXd& Z_below);
  void GatherFrom(const Shape& ancestor, const int* cols, int col_count, int first, Eigen::MatrixXd& Z_below) const;

  SupernodalView L_;
  std::vector<int> supernode_of_col_;
  std::vector<int> place_;      // of a row among the rows below the supernode at hand; -1: not there
  std::vector<double> values_;  // of the inverse, in the layout of L
};

}  // namespace rigcal::graph
