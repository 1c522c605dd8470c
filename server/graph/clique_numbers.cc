// The numbers of a tree of cliques: making a clique's columns from its edges and from what its children leave, and the
// solves.
#include <Eigen/Cholesky>

#include "server/graph/clique_tree.h"

namespace rigcal::graph {
namespace {

// One half of a solve: blocks with vectors count a sixth.
double ProductsOfHalf(double own, double below) { return (own * own / 2.0 + own * below) / 6.0; }

}  // namespace

bool CliqueTree::Factor(Clique& clique) {
  const auto size = static_cast<Eigen::Index>(6 * clique.blocks.size());
  const Eigen::Index own = 6 * clique.own_count, below = size - own;
  front_.assign(static_cast<std::size_t>(size * size), 0.0);
  Eigen::Map<Eigen::MatrixXd> front(front_.data(), size, size);
  for (std::size_t k = 0; k < clique.blocks.size(); ++k)
    place_[static_cast<std::size_t>(clique.blocks[k])] = static_cast<int>(6 * k);
  AddEdges(clique, front);
  for (const int child : clique.children) AddLeft(cliques_[static_cast<std::size_t>(child)], front);
  for (const int block : clique.blocks) place_[static_cast<std::size_t>(block)] = -1;
  auto L_own = front.topLeftCorner(own, own);
  Eigen::Ref<Eigen::MatrixXd> in_place(L_own);
  if (Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() != Eigen::Success) return false;
  clique.left.resize(below, below);
  if (below > 0) {
    auto L_below = front.bottomLeftCorner(below, own);
    L_own.transpose().template triangularView<Eigen::Upper>().template solveInPlace<Eigen::OnTheRight>(L_below);
    clique.left.triangularView<Eigen::Lower>() = front.bottomRightCorner(below, below);
    clique.left.selfadjointView<Eigen::Lower>().rankUpdate(L_below, -1.0);
  }
  clique.L = front.leftCols(own);
  return true;
}

// Each edge belongs to the clique of the first of its blocks.
void CliqueTree::AddEdges(const Clique& clique, Eigen::Map<Eigen::MatrixXd>& front) {
  for (int k = 0; k < clique.own_count; ++k) {
    const int block = clique.blocks[static_cast<std::size_t>(k)];
    for (const int number : edges_of_block_[static_cast<std::size_t>(block)]) {
      const Edge& edge = edges_[static_cast<std::size_t>(number)];
      const bool is_i = edge.i == block;
      const int other = is_i ? edge.j : edge.i;
      if (other >= 0 && rank_[static_cast<std::size_t>(other)] < rank_[static_cast<std::size_t>(block)]) continue;
      const Matrix6d &U = is_i ? edge.U_i : edge.U_j, &V = is_i ? edge.U_j : edge.U_i;
      const Eigen::Index at = 6 * k;
      front.block<6, 6>(at, at).noalias() += U * U.transpose();
      if (other < 0) continue;
      const Eigen::Index there = place_[static_cast<std::size_t>(other)];
      front.block<6, 6>(there, there).noalias() += V * V.transpose();
      front.block<6, 6>(there, at).noalias() += V * U.transpose();
    }
  }
}

void CliqueTree::AddLeft(const Clique& child, Eigen::Map<Eigen::MatrixXd>& front) {
  if (child.left.size() == 0) return;
  const int count = child.below_count();
  const int* blocks = child.blocks.data() + child.own_count;
  for (int c = 0; c < count; ++c) {
    const Eigen::Index at_c = place_[static_cast<std::size_t>(blocks[c])];
    for (int r = c; r < count; ++r) {
      const Eigen::Index at_r = place_[static_cast<std::size_t>(blocks[r])];
      if (at_r >= at_c)
        front.block<6, 6>(at_r, at_c) += child.left.block<6, 6>(6 * r, 6 * c);
      else
        front.block<6, 6>(at_c, at_r) += child.left.block<6, 6>(6 * r, 6 * c).transpose();
    }
  }
}

void CliqueTree::Forward(Clique& clique, const Eigen::VectorXd& x) {
  const Eigen::Index own = 6 * clique.own_count, below = 6 * clique.below_count();
  above_.setZero(own + below);
  for (std::size_t k = 0; k < clique.blocks.size(); ++k)
    place_[static_cast<std::size_t>(clique.blocks[k])] = static_cast<int>(6 * k);
  for (int k = 0; k < clique.own_count; ++k)
    above_.segment<6>(6 * k) = x.segment<6>(6 * clique.blocks[static_cast<std::size_t>(k)]);
  for (const int id : clique.children) {
    const Clique& child = cliques_[static_cast<std::size_t>(id)];
    for (int k = 0; k < child.below_count(); ++k)
      above_.segment<6>(
          place_[static_cast<std::size_t>(child.blocks[static_cast<std::size_t>(child.own_count + k)])]) +=
          child.passed.segment<6>(6 * k);
  }
  for (const int block : clique.blocks) place_[static_cast<std::size_t>(block)] = -1;
  clique.y = above_.head(own);
  clique.L.topRows(own).triangularView<Eigen::Lower>().solveInPlace(clique.y);
  clique.passed = above_.tail(below);
  if (below > 0) clique.passed.noalias() -= clique.L.bottomRows(below) * clique.y;
  clique.gain = clique.y.squaredNorm();
  clique.stale = false;
  products_ += ProductsOfHalf(clique.own_count, clique.below_count());
}

double CliqueTree::Reduce(const Eigen::VectorXd& x) {
  double gain = 0.0;
  for (std::size_t k = order_.size(); k-- > 0;) {
    Clique& clique = cliques_[static_cast<std::size_t>(order_[k])];
    if (clique.stale) Forward(clique, x);
    gain += clique.gain;
  }
  return gain;
}

void CliqueTree::TouchAll() {
  for (const int id : order_) cliques_[static_cast<std::size_t>(id)].stale = true;
}

void CliqueTree::Finish(Eigen::VectorXd& x) {
  x.setZero();
  for (const int id : order_) {
    const Clique& clique = cliques_[static_cast<std::size_t>(id)];
    const Eigen::Index own = 6 * clique.own_count, below = 6 * clique.below_count();
    above_.resize(below);
    for (int k = 0; k < clique.below_count(); ++k)
      above_.segment<6>(6 * k) = x.segment<6>(6 * clique.blocks[static_cast<std::size_t>(clique.own_count + k)]);
    step_ = clique.y;
    if (below > 0) step_.noalias() -= clique.L.bottomRows(below).transpose() * above_;
    clique.L.topRows(own).transpose().triangularView<Eigen::Upper>().solveInPlace(step_);
    for (int k = 0; k < clique.own_count; ++k)
      x.segment<6>(6 * clique.blocks[static_cast<std::size_t>(k)]) = step_.segment<6>(6 * k);
    products_ += ProductsOfHalf(clique.own_count, clique.below_count());
  }
}

}  // namespace rigcal::graph
