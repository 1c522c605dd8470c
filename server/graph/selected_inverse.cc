#include "server/graph/selected_inverse.h"

#include <Eigen/LU>
#include <algorithm>

namespace rigcal::graph {
namespace {

using Strided = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using ConstStrided = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

}  // namespace

SelectedInverse::SelectedInverse(const SupernodalView& L)
    : L_(L), supernode_of_col_(static_cast<std::size_t>(L.size)), place_(static_cast<std::size_t>(L.size), -1),
      values_(L.value_count) {
  for (int s = 0; s < L.supernode_count; ++s)
    std::fill(supernode_of_col_.begin() + L.super[s], supernode_of_col_.begin() + L.super[s + 1], s);
  for (int s = L.supernode_count - 1; s >= 0; --s) InvertSupernode(s);
}

SelectedInverse::Shape SelectedInverse::ShapeOf(int s) const {
  return {L_.super[s], L_.super[s + 1] - L_.super[s], L_.row_start[s + 1] - L_.row_start[s], L_.rows + L_.row_start[s],
          static_cast<std::size_t>(L_.value_start[s])};
}

// Z_RJ = -Z_RR Y and Z_JJ = L_JJ^-T L_JJ^-1 - Y^T Z_RJ with Y = L_RJ L_JJ^-1, R the rows below the supernode J.
void SelectedInverse::InvertSupernode(int s) {
  const Shape shape = ShapeOf(s);
  const int below = shape.row_count - shape.col_count;
  const ConstStrided L(L_.values + shape.start, shape.row_count, shape.col_count, Eigen::OuterStride<>(shape.row_count));
  Strided Z(values_.data() + shape.start, shape.row_count, shape.col_count, Eigen::OuterStride<>(shape.row_count));
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
void SelectedInverse::GatherAncestors(const Shape& shape, Eigen::MatrixXd& Z_below) {
  const int* rows = shape.rows + shape.col_count;
  const int below = shape.row_count - shape.col_count;
  for (int k = 0; k < below; ++k) place_[static_cast<std::size_t>(rows[k])] = k;
  for (int first = 0, last = 0; first < below; first = last) {
    const int ancestor = supernode_of_col_[static_cast<std::size_t>(rows[first])];
    while (last < below && supernode_of_col_[static_cast<std::size_t>(rows[last])] == ancestor) ++last;
    GatherFrom(ShapeOf(ancestor), rows + first, last - first, first, Z_below);
  }
  for (int k = 0; k < below; ++k) place_[static_cast<std::size_t>(rows[k])] = -1;
}

void SelectedInverse::GatherFrom(const Shape& ancestor, const int* cols, int col_count, int first,
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
  const Shape shape = ShapeOf(supernode_of_col_[static_cast<std::size_t>(col)]);
  const int* found = std::lower_bound(shape.rows, shape.rows + shape.row_count, row);
  const auto k = static_cast<std::size_t>(found - shape.rows);
  return values_[shape.start + k + static_cast<std::size_t>(col - shape.first_col) * static_cast<std::size_t>(shape.row_count)];
}

}  // namespace rigcal::graph
