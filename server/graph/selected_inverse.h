// The entries of (L L^T)^-1 on the pattern of L (Takahashi's recursion, supernode by supernode, last to first), exact
// up to rounding, without the inverse itself.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/graph/supernodes.h"

namespace rigcal::graph {

class SelectedInverse {
 public:
  // `values` of L in the layout of `supernodes`; both are used by the constructor only, the shape by At() too.
  SelectedInverse(const Supernodes& supernodes, const std::vector<double>& values);
  // Entry (row, col) of the inverse, in positions of the factor; it must lie in the pattern of L (any entry of A does).
  [[nodiscard]] double At(int row, int col) const;

 private:
  void InvertSupernode(int s, const std::vector<double>& L_values);
  void GatherAncestors(const Supernode& supernode, Eigen::MatrixXd& Z_below);
  void GatherFrom(const Supernode& ancestor, const int* cols, int col_count, int first, Eigen::MatrixXd& Z_below) const;

  const Supernodes& shape_;
  std::vector<int> place_;      // of a row among the rows below the supernode at hand; -1: not there
  std::vector<double> values_;  // of the inverse, in the layout of L
};

}  // namespace rigcal::graph
