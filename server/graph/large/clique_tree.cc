#include "server/graph/large/clique_tree.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace rigcal::graph {
namespace {

constexpr int kHopsNear = 3;

double ProductsOfFactor(double own, double below) {
  return own * own * own / 6.0 + own * own * below / 2.0 + own * below * below / 2.0;
}

// One half of a solve: blocks with vectors count a sixth.
double ProductsOfHalf(double own, double below) { return (own * own / 2.0 + own * below) / 6.0; }

// The same pattern in elimination order, every link once.
BlockPattern InOrder(BlockPattern pattern, const std::vector<int>& order) {
  std::vector<int> position(order.size());
  for (std::size_t p = 0; p < order.size(); ++p) position[static_cast<std::size_t>(order[p])] = static_cast<int>(p);
  std::vector<BlockPosition>& links = pattern.off_diagonal;
  for (BlockPosition& at : links) {
    const auto [low, high] =
        std::minmax(position[static_cast<std::size_t>(at.row)], position[static_cast<std::size_t>(at.col)]);
    at = {high, low};
  }
  std::sort(links.begin(), links.end());
  links.erase(std::unique(links.begin(), links.end()), links.end());
  return pattern;
}

}  // namespace

void CliqueTree::Clear() { *this = CliqueTree(); }

void CliqueTree::Reserve(int block) {
  if (block < block_count()) return;
  const auto count = static_cast<std::size_t>(block) + 1;
  edges_of_block_.resize(count);
  owner_.resize(count, -1), place_.resize(count, -1), rank_.resize(count, -1);
}

void CliqueTree::Take(std::size_t number, const Edge& edge) {
  if (edges_.size() <= number) edges_.resize(number + 1);
  edges_[number] = edge;
  for (const int block : {edge.i, edge.j}) {
    if (block < 0) continue;
    Reserve(block);
    edges_of_block_[static_cast<std::size_t>(block)].push_back(static_cast<int>(number));
    touched_.push_back(block);
  }
}

void CliqueTree::Change(std::size_t number) {
  for (const int block : {edges_[number].i, edges_[number].j})
    if (block >= 0) touched_.push_back(block);
}

void CliqueTree::Drop(std::size_t number, std::size_t largest) {
  const auto renumber = [this](std::size_t from, int to) {
    for (const int block : {edges_[from].i, edges_[from].j}) {
      if (block < 0) continue;
      std::vector<int>& numbers = edges_of_block_[static_cast<std::size_t>(block)];
      const auto at = std::find(numbers.begin(), numbers.end(), static_cast<int>(from));
      if (to < 0) {
        numbers.erase(at);
      } else {
        *at = to;
      }
    }
  };
  Change(number);
  renumber(number, -1);
  if (largest < edges_.size() && largest != number) renumber(largest, static_cast<int>(number));
  edges_[number] = largest < edges_.size() ? edges_[largest] : Edge();
  edges_.resize(std::min(edges_.size(), largest));
}

void CliqueTree::Replace(std::size_t number, const Edge& edge) { edges_[number] = edge; }

bool CliqueTree::Renew(int near_i, int near_j, double products_max) {
  if (part_.blocks.empty()) return true;
  Arrange(near_i, near_j);
  if (part_.shape.size == 0 || part_.products > products_max) return false;
  const std::vector<int> made = Install();
  Adopt(made);
  bool definite = true;
  for (auto id = made.begin(); id != made.end() && definite; ++id)
    definite = Factor(cliques_[static_cast<std::size_t>(*id)]);
  for (const int block : part_.blocks) rank_[static_cast<std::size_t>(block)] = -1;
  products_ += part_.products;
  columns_ += static_cast<int>(part_.blocks.size());
  part_ = Part();
  return definite;
}

// What hangs below the touched blocks stays; they and all above them do not.
std::vector<int> CliqueTree::Open() {
  for (const int block : touched_) OpenAbove(block);
  touched_.clear();
  std::sort(part_.blocks.begin(), part_.blocks.end());
  part_.blocks.erase(std::unique(part_.blocks.begin(), part_.blocks.end()), part_.blocks.end());
  for (const int id : part_.opened)
    for (const int child : cliques_[static_cast<std::size_t>(id)].children)
      if (!cliques_[static_cast<std::size_t>(child)].open) part_.orphans.push_back(child);
  for (std::size_t k = 0; k < part_.blocks.size(); ++k)
    place_[static_cast<std::size_t>(part_.blocks[k])] = static_cast<int>(k);
  std::vector<int> within;
  for (const int block : part_.blocks) {
    for (const int number : edges_of_block_[static_cast<std::size_t>(block)]) {
      const Edge& edge = edges_[static_cast<std::size_t>(number)];
      const int other = edge.i == block ? edge.j : edge.i;
      if (other < 0 || place_[static_cast<std::size_t>(other)] > place_[static_cast<std::size_t>(block)])
        within.push_back(number);
    }
  }
  for (const int block : part_.blocks) place_[static_cast<std::size_t>(block)] = -1;
  return within;
}

void CliqueTree::OpenAbove(int block) {
  if (owner_[static_cast<std::size_t>(block)] < 0) part_.blocks.push_back(block);
  for (int id = owner_[static_cast<std::size_t>(block)]; id >= 0;) {
    Clique& clique = cliques_[static_cast<std::size_t>(id)];
    if (clique.open) return;
    clique.open = true;
    part_.opened.push_back(id);
    part_.blocks.insert(part_.blocks.end(), clique.blocks.begin(), clique.blocks.begin() + clique.own_count);
    id = clique.parent;
  }
}

// Edges within the part, and whatever an orphan hangs on, in numbers of the part's list (place_).
BlockPattern CliqueTree::Pattern() const {
  const Part& part = part_;
  BlockPattern pattern;
  pattern.block_count = static_cast<int>(part.blocks.size());
  const auto link = [&pattern](int a, int b) { pattern.off_diagonal.push_back({std::max(a, b), std::min(a, b)}); };
  for (const int block : part.blocks) {
    for (const int number : edges_of_block_[static_cast<std::size_t>(block)]) {
      const Edge& edge = edges_[static_cast<std::size_t>(number)];
      const int other = edge.i == block ? edge.j : edge.i;
      const int a = place_[static_cast<std::size_t>(block)],
                b = other < 0 ? -1 : place_[static_cast<std::size_t>(other)];
      if (b >= 0 && a < b) link(a, b);
    }
  }
  for (const int id : part.orphans) {
    const Clique& orphan = cliques_[static_cast<std::size_t>(id)];
    for (std::size_t a = static_cast<std::size_t>(orphan.own_count); a < orphan.blocks.size(); ++a)
      for (std::size_t b = static_cast<std::size_t>(orphan.own_count); b < a; ++b)
        link(place_[static_cast<std::size_t>(orphan.blocks[a])], place_[static_cast<std::size_t>(orphan.blocks[b])]);
  }
  return pattern;
}

// What is no more than kHopsNear edges away.
std::vector<bool> CliqueTree::Near(const BlockPattern& pattern, int near_i, int near_j) const {
  std::vector<bool> is_near(static_cast<std::size_t>(pattern.block_count), false);
  std::vector<int> found;
  const auto find = [this, &is_near, &found](int block) {
    const int k = block < 0 || block >= block_count() ? -1 : place_[static_cast<std::size_t>(block)];
    if (k < 0 || is_near[static_cast<std::size_t>(k)]) return;
    is_near[static_cast<std::size_t>(k)] = true;
    found.push_back(block);
  };
  find(near_i), find(near_j);
  std::size_t at = 0;
  for (int hop = 0; hop < kHopsNear; ++hop) {
    for (const std::size_t end = found.size(); at < end; ++at) {
      for (const int number : edges_of_block_[static_cast<std::size_t>(found[at])]) {
        const Edge& edge = edges_[static_cast<std::size_t>(number)];
        find(edge.i), find(edge.j);
      }
    }
  }
  return is_near;
}

// Orders the part and finds its new cliques.
void CliqueTree::Arrange(int near_i, int near_j) {
  Part& part = part_;
  for (std::size_t k = 0; k < part.blocks.size(); ++k)
    place_[static_cast<std::size_t>(part.blocks[k])] = static_cast<int>(k);
  BlockPattern pattern = Pattern();
  const std::vector<bool> is_last = Near(pattern, near_i, near_j);
  for (const int block : part.blocks) place_[static_cast<std::size_t>(block)] = -1;
  const std::vector<int> order = ConstrainedOrder(pattern, is_last);
  part.shape = AnalyzeSupernodes(InOrder(pattern, order), 1);
  if (part.shape.size == 0) return;
  part.block_at.resize(order.size());
  for (std::size_t p = 0; p < order.size(); ++p)
    part.block_at[static_cast<std::size_t>(part.shape.position[p])] = part.blocks[static_cast<std::size_t>(order[p])];
  double bytes = 0.0;
  for (int s = 0; s < part.shape.count(); ++s) {
    const Supernode supernode = SliceOf(part.shape, s);
    part.products += ProductsOfFactor(supernode.col_count, supernode.below());
    bytes += 288.0 * (supernode.row_count * supernode.col_count + supernode.below() * supernode.below());
  }
  if (bytes > static_cast<double>(kFactorBytesMax)) part.shape.size = 0;
}

// The new cliques take the place of the opened ones. Gives them, children first.
std::vector<int> CliqueTree::Install() {
  const Part& part = part_;
  std::vector<int> made;
  vacant_.insert(vacant_.end(), part.opened.begin(), part.opened.end());
  order_.erase(std::remove_if(order_.begin(), order_.end(),
                              [this](int id) { return cliques_[static_cast<std::size_t>(id)].open; }),
               order_.end());
  for (std::size_t p = 0; p < part.block_at.size(); ++p)
    rank_[static_cast<std::size_t>(part.block_at[p])] = static_cast<int>(p);
  for (int s = 0; s < part.shape.count(); ++s) {
    if (vacant_.empty()) vacant_.push_back(static_cast<int>(cliques_.size())), cliques_.emplace_back();
    made.push_back(vacant_.back());
    vacant_.pop_back();
    Clique& clique = cliques_[static_cast<std::size_t>(made.back())];
    const Supernode supernode = SliceOf(part.shape, s);
    clique.blocks.clear(), clique.children.clear();
    for (int k = 0; k < supernode.row_count; ++k)
      clique.blocks.push_back(part.block_at[static_cast<std::size_t>(supernode.rows[k])]);
    clique.own_count = supernode.col_count;
    clique.stale = true, clique.open = false;
    for (int k = 0; k < clique.own_count; ++k)
      owner_[static_cast<std::size_t>(clique.blocks[static_cast<std::size_t>(k)])] = made.back();
  }
  order_.insert(order_.begin(), made.rbegin(), made.rend());
  return made;
}

// Every clique hangs on the owner of the first block below it, in the new order.
void CliqueTree::Adopt(const std::vector<int>& made) {
  const auto adopt = [this](int id) {
    Clique& clique = cliques_[static_cast<std::size_t>(id)];
    clique.parent = -1;
    if (clique.below_count() == 0) return;
    const int first = *std::min_element(
        clique.blocks.begin() + clique.own_count, clique.blocks.end(),
        [this](int a, int b) { return rank_[static_cast<std::size_t>(a)] < rank_[static_cast<std::size_t>(b)]; });
    clique.parent = owner_[static_cast<std::size_t>(first)];
    cliques_[static_cast<std::size_t>(clique.parent)].children.push_back(id);
  };
  for (const int id : part_.orphans) adopt(id);
  for (const int id : made) adopt(id);
}

// From here on the numbers: making a clique's columns from its edges and from what its children leave, and the solves.

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
