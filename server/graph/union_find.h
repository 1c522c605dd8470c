// Disjoint sets of small integers.
#pragma once

#include <numeric>
#include <utility>
#include <vector>

namespace rigcal::graph {

class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  // The smallest member of the set of `member`.
  [[nodiscard]] int Find(int member) {
    while (At(member) != member) member = At(member) = At(At(member));
    return member;
  }
  // False if both were in one set already.
  bool Join(int a, int b) {
    a = Find(a), b = Find(b);
    if (a > b) std::swap(a, b);
    At(b) = a;
    return a != b;
  }

 private:
  int& At(int member) { return parent_[static_cast<std::size_t>(member)]; }
  std::vector<int> parent_;
};

}  // namespace rigcal::graph
