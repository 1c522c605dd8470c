#include "server/graph/growing_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <tuple>

namespace rigcal::graph {
namespace {

// The same matrix in elimination order.
struct Ordered {
  BlockPattern pattern;
  BlockMatrix<6> H;
  std::vector<int> position;  // of a block
};

Ordered InOrder(const BlockPattern& pattern, const BlockMatrix<6>& H, const std::vector<int>& order) {
  Ordered result;
  result.position.resize(order.size());
  for (std::size_t p = 0; p < order.size(); ++p) {
    result.position[static_cast<std::size_t>(order[p])] = static_cast<int>(p);
    result.H.diagonal.push_back(H.diagonal[static_cast<std::size_t>(order[p])]);
  }
  std::vector<std::tuple<int, int, std::size_t>> places;  // column, row, slot
  for (std::size_t s = 0; s < pattern.off_diagonal.size(); ++s) {
    const auto [low, high] = std::minmax(result.position[static_cast<std::size_t>(pattern.off_diagonal[s].row)],
                                         result.position[static_cast<std::size_t>(pattern.off_diagonal[s].col)]);
    places.emplace_back(low, high, s);
  }
  std::sort(places.begin(), places.end());
  result.pattern.block_count = pattern.block_count;
  for (const auto& [col, row, slot] : places) {
    result.pattern.off_diagonal.push_back({row, col});
    const bool swapped = result.position[static_cast<std::size_t>(pattern.off_diagonal[slot].row)] != row;
    result.H.off_diagonal.push_back(swapped ? Matrix6d(H.off_diagonal[slot].transpose()) : H.off_diagonal[slot]);
  }
  return result;
}

// Every supernode's first row below it lies in its parent.
std::vector<int> ParentsOf(const Supernodes& shape) {
  std::vector<int> parents;
  for (int s = 0; s < shape.count(); ++s) {
    const Supernode supernode = SliceOf(shape, s);
    parents.push_back(
        supernode.below() == 0 ? -1 : shape.supernode_of_col[static_cast<std::size_t>(supernode.rows_below()[0])]);
  }
  return parents;
}

}  // namespace

bool GrowingFactor::Renew(const BlockPattern& pattern, const BlockMatrix<6>& H, double products_max) {
  base_.reset();
  leaves_.clear(), corrections_.clear(), row_of_block_.clear(), on_path_of_leaf_.clear();
  std::vector<std::pair<int, int>> links;
  for (const BlockPosition& at : pattern.off_diagonal) links.emplace_back(at.row, at.col);
  const Elimination elimination = EliminationOrder(pattern.block_count, links);
  products_of_factor_ = elimination.cost.flops;
  products_of_solve_ = 2.0 * elimination.cost.entries / 6.0;  // of a block with six numbers
  if (products_of_factor_ > products_max) return false;
  const Ordered ordered = InOrder(pattern, H, elimination.order);
  Supernodes shape = AnalyzeSupernodes(ordered.pattern, 6);
  if (shape.size == 0) return false;
  base_count_ = pattern.block_count;
  for (const int p : ordered.position) row_of_block_.push_back(shape.position[6 * static_cast<std::size_t>(p)]);
  parent_of_supernode_ = ParentsOf(shape);
  on_path_of_supernode_.assign(parent_of_supernode_.size(), false);
  wide_.setZero(6 * base_count_, 6);
  base_ = std::make_unique<SparseCholesky<6>>(ordered.pattern, std::move(shape));
  return base_->Factor(ordered.H, 0.0);
}

bool GrowingFactor::AddLeaf(int parent, const Matrix6d& H_leaf, const Matrix6d& H_parent_leaf) {
  Leaf leaf;
  leaf.parent = parent;
  leaf.L = H_leaf;
  leaf.B = H_parent_leaf;
  if (!FactorBlock<6>(leaf.L)) return false;
  DivideByTransposed<6>(leaf.L, leaf.B);
  row_of_block_.push_back(6 * static_cast<int>(row_of_block_.size()));
  leaves_.push_back(leaf);
  on_path_of_leaf_.push_back(false);
  return true;
}

void GrowingFactor::MarkPath(int block) {
  for (; block >= base_count_; block = leaves_[static_cast<std::size_t>(block - base_count_)].parent) {
    const auto k = static_cast<std::size_t>(block - base_count_);
    if (on_path_of_leaf_[k]) return;
    on_path_of_leaf_[k] = true;
    path_leaves_.push_back(static_cast<int>(k));
  }
  if (block < 0) return;
  const int row = row_of_block_[static_cast<std::size_t>(block)];
  for (int s = base_->shape().supernode_of_col[static_cast<std::size_t>(row)]; s >= 0;
       s = parent_of_supernode_[static_cast<std::size_t>(s)]) {
    if (on_path_of_supernode_[static_cast<std::size_t>(s)]) return;
    on_path_of_supernode_[static_cast<std::size_t>(s)] = true;
    path_supernodes_.push_back(s);
  }
}

// wide_ <- L^-1 wide_, which is zero but on the path.
void GrowingFactor::ReducePath() {
  std::sort(path_leaves_.rbegin(), path_leaves_.rend());
  std::sort(path_supernodes_.begin(), path_supernodes_.end());
  for (const int k : path_leaves_) {
    const Leaf& leaf = leaves_[static_cast<std::size_t>(k)];
    Matrix6d rows = wide_.middleRows<6>(6 * (base_count_ + k)).transpose();
    DivideByTransposed<6>(leaf.L, rows);
    wide_.middleRows<6>(6 * (base_count_ + k)) = rows.transpose();
    if (leaf.parent < 0) continue;
    wide_.middleRows<6>(row_of_block_[static_cast<std::size_t>(leaf.parent)]) -= leaf.B * rows.transpose();
  }
  for (const int s : path_supernodes_) base_->Forward(s, wide_, wide_below_);
}

// Takes what is on the path out of wide_ and forgets the path.
void GrowingFactor::KeepPath(Correction& correction) {
  for (const int s : path_supernodes_) {
    const Supernode supernode = SliceOf(base_->shape(), s);
    correction.rows.push_back({supernode.first_col, supernode.col_count});
    on_path_of_supernode_[static_cast<std::size_t>(s)] = false;
  }
  for (const int k : path_leaves_) {
    correction.rows.push_back({6 * (base_count_ + k), 6});
    on_path_of_leaf_[static_cast<std::size_t>(k)] = false;
  }
  path_leaves_.clear(), path_supernodes_.clear();
  int total = 0;
  for (const Rows& rows : correction.rows) total += rows.count;
  correction.W.resize(total, 6);
  int at = 0;
  for (const Rows& rows : correction.rows) {
    correction.W.middleRows(at, rows.count) = wide_.middleRows(rows.first, rows.count);
    wide_.middleRows(rows.first, rows.count).setZero();
    at += rows.count;
  }
}

int GrowingFactor::AddEdge(double sign, int i, const Matrix6d& U_i, int j, const Matrix6d& U_j) {
  const auto size = static_cast<Eigen::Index>(6 * row_of_block_.size());
  if (wide_.rows() < size) wide_.setZero(std::max<Eigen::Index>(size, 2 * wide_.rows()), 6);
  for (const auto& [block, U] : {std::pair(i, &U_i), std::pair(j, &U_j)}) {
    if (block < 0) continue;
    wide_.middleRows<6>(row_of_block_[static_cast<std::size_t>(block)]) += *U;
    MarkPath(block);
  }
  ReducePath();
  Correction added;
  added.sign = sign;
  KeepPath(added);
  if (!Extend(added)) return -1;
  const auto columns = static_cast<int>(added.W.rows() / 6);
  corrections_.push_back(std::move(added));
  return columns;
}

// One more block row of the factor M D M^T of D + W^T W, D = +-1 block by block. H is positive definite with and
// without the edge, so the last block before the root is taken is definite, of the edge's sign.
bool GrowingFactor::Extend(const Correction& added) {
  const auto old = static_cast<Eigen::Index>(6 * corrections_.size());
  if (S_.rows() < old + 6) S_.conservativeResize(2 * old + 6, 2 * old + 6);
  int at = 0;
  for (const Rows& rows : added.rows) {
    wide_.middleRows(rows.first, rows.count) = added.W.middleRows(at, rows.count);
    at += rows.count;
  }
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(old, 6);  // W_old^T W_new
  for (std::size_t k = 0; k < corrections_.size(); ++k) {
    at = 0;
    for (const Rows& rows : corrections_[k].rows) {
      products.middleRows<6>(6 * static_cast<Eigen::Index>(k)).noalias() +=
          corrections_[k].W.middleRows(at, rows.count).transpose() * wide_.middleRows(rows.first, rows.count);
      at += rows.count;
    }
  }
  for (const Rows& rows : added.rows) wide_.middleRows(rows.first, rows.count).setZero();
  if (old > 0) S_.topLeftCorner(old, old).triangularView<Eigen::Lower>().solveInPlace(products);
  Eigen::MatrixXd signed_products = products;
  for (std::size_t k = 0; k < corrections_.size(); ++k)
    signed_products.middleRows<6>(6 * static_cast<Eigen::Index>(k)) *= corrections_[k].sign;
  const Matrix6d rest =
      Matrix6d::Identity() + added.sign * (added.W.transpose() * added.W - products.transpose() * signed_products);
  const Eigen::LLT<Matrix6d> root(rest);
  S_.block(old, 0, 6, old) = signed_products.transpose();
  S_.block<6, 6>(old, old) = root.matrixL();
  return root.info() == Eigen::Success;
}

double GrowingFactor::Reduce(const Eigen::VectorXd& x) {
  const auto base = static_cast<std::size_t>(base_count_);
  y_.resize(x.size());
  for (std::size_t v = 0; v < row_of_block_.size(); ++v)
    y_.segment<6>(row_of_block_[v]) = x.segment<6>(6 * static_cast<Eigen::Index>(v));
  for (std::size_t k = leaves_.size(); k-- > 0;) {
    const Leaf& leaf = leaves_[k];
    Vector6d part = y_.segment<6>(row_of_block_[base + k]);
    SolveLower<6>(leaf.L, part);
    y_.segment<6>(row_of_block_[base + k]) = part;
    if (leaf.parent >= 0) y_.segment<6>(row_of_block_[static_cast<std::size_t>(leaf.parent)]) -= leaf.B * part;
  }
  for (int s = 0; s < base_->shape().count(); ++s) base_->Forward(s, y_, below_);
  w_.setZero(6 * corrections());
  for (std::size_t k = 0; k < corrections_.size(); ++k) {
    Eigen::Index at = 0;
    for (const Rows& rows : corrections_[k].rows) {
      w_.segment<6>(6 * static_cast<Eigen::Index>(k)).noalias() +=
          corrections_[k].W.middleRows(at, rows.count).transpose() * y_.segment(rows.first, rows.count);
      at += rows.count;
    }
  }
  const auto M = S_.topLeftCorner(w_.size(), w_.size()).triangularView<Eigen::Lower>();
  M.solveInPlace(w_);
  double gain = y_.squaredNorm();
  for (std::size_t k = 0; k < corrections_.size(); ++k) {
    auto part = w_.segment<6>(6 * static_cast<Eigen::Index>(k));
    gain -= corrections_[k].sign * part.squaredNorm();
    part *= corrections_[k].sign;
  }
  M.transpose().solveInPlace(w_);
  return gain;
}

void GrowingFactor::Finish(Eigen::VectorXd& x) {
  for (std::size_t k = 0; k < corrections_.size(); ++k) {
    Eigen::Index at = 0;
    for (const Rows& rows : corrections_[k].rows) {
      y_.segment(rows.first, rows.count).noalias() -=
          corrections_[k].W.middleRows(at, rows.count) * w_.segment<6>(6 * static_cast<Eigen::Index>(k));
      at += rows.count;
    }
  }
  for (int s = base_->shape().count(); s-- > 0;) base_->Backward(s, y_, below_);
  for (std::size_t k = 0; k < leaves_.size(); ++k) {
    const Leaf& leaf = leaves_[k];
    Vector6d part = y_.segment<6>(row_of_block_[static_cast<std::size_t>(base_count_) + k]);
    if (leaf.parent >= 0)
      part -= leaf.B.transpose() * y_.segment<6>(row_of_block_[static_cast<std::size_t>(leaf.parent)]);
    SolveLowerTransposed<6>(leaf.L, part);
    y_.segment<6>(row_of_block_[static_cast<std::size_t>(base_count_) + k]) = part;
  }
  x.resize(y_.size());
  for (std::size_t v = 0; v < row_of_block_.size(); ++v)
    x.segment<6>(6 * static_cast<Eigen::Index>(v)) = y_.segment<6>(row_of_block_[v]);
}

}  // namespace rigcal::graph
