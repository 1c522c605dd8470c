#include "server/graph/selected_inverse.h"

#include <algorithm>

namespace rigcal::graph {
SelectedInverse::SelectedInverse(const Supernodes& supernodes, const std::vector<double>& values)
    : shape_(supernodes), place_(static_cast<std::size_t>(supernodes.size), -1), values_(values.size()) {
  for (int s = supernodes.count() - 1; s >= 0; --s) InvertSupernode(s, values);
}

// Z_RJ = -Z_RR Y and Z_JJ = L_JJ^-T L_JJ^-1 - Y^T Z_RJ with Y = L_RJ L_JJ^-1, R the rows below the supernode J.
void SelectedInverse::InvertSupernode(int s, const std::vector<double>& L_values) {
  const Supernode shape = SliceOf(shape_, s);
  const int below = shape.below();
  const Eigen::Map<const Eigen::MatrixXd> L(L_values.data() + shape.start, shape.row_count, shape.col_count);
  Eigen::Map<Eigen::MatrixXd> Z(values_.data() + shape.start, shape.row_count, shape.col_count);
  const auto L_JJ = L.topRows(shape.col_count).triangularView<Eigen::Lower>();
  Eigen::MatrixXd L_inverse = Eigen::MatrixXd::Identity(shape.col_count, shape.col_count);
  L_JJ.solveInPlace(L_inverse);
  Eigen::MatrixXd Z_JJ = L_inverse.transpose() * L_inverse;
  if (below > 0) {
    Eigen::MatrixXd Z_RR(below, below);
    GatherAncestors(shape, Z_RR);
    const Eigen::MatrixXd Y = L.bottomRows(below) * L_inverse;
    Z.bottomRows(below).noalias() = -(Z_RR.selfadjointView<Eigen::Lower>() * Y);
    Z_JJ.noalias() -= Y.transpose() * Z.bottomRows(below);
  }
  Z.topRows(shape.col_count) = 0.5 * (Z_JJ + Z_JJ.transpose());
}

// The rows below a supernode are a clique of the filled graph: all their entries were computed before.
void SelectedInverse::GatherAncestors(const Supernode& supernode, Eigen::MatrixXd& Z_below) {
  const int* rows = supernode.rows_below();
  const int below = supernode.below();
  for (int k = 0; k < below; ++k) place_[static_cast<std::size_t>(rows[k])] = k;
  for (int first = 0, last = 0; first < below; first = last) {
    const int ancestor = shape_.supernode_of_col[static_cast<std::size_t>(rows[first])];
    while (last < below && shape_.supernode_of_col[static_cast<std::size_t>(rows[last])] == ancestor) ++last;
    GatherFrom(SliceOf(shape_, ancestor), rows + first, last - first, first, Z_below);
  }
  for (int k = 0; k < below; ++k) place_[static_cast<std::size_t>(rows[k])] = -1;
}

void SelectedInverse::GatherFrom(const Supernode& ancestor, const int* cols, int col_count, int first,
                                 Eigen::MatrixXd& Z_below) const {
  for (int k = 0; k < ancestor.row_count; ++k) {
    const int row = place_[static_cast<std::size_t>(ancestor.rows[k])];
    if (row < 0) continue;
    const double* source = values_.data() + ancestor.start + k;
    for (int c = 0; c < col_count; ++c) {
      const int column = cols[c] - ancestor.first_col;
      if (row >= first + c) Z_below(row, first + c) = source[static_cast<std::ptrdiff_t>(column) * ancestor.row_count];
    }
  }
}

double SelectedInverse::At(int row, int col) const {
  if (row < col) std::swap(row, col);
  const Supernode shape = SliceOf(shape_, shape_.supernode_of_col[static_cast<std::size_t>(col)]);
  const int* found = std::lower_bound(shape.rows, shape.rows + shape.row_count, row);
  const auto k = static_cast<std::size_t>(found - shape.rows);
  return values_[shape.start + k +
                 static_cast<std::size_t>(col - shape.first_col) * static_cast<std::size_t>(shape.row_count)];
}

}  // namespace rigcal::graph
