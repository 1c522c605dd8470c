// Which cameras saw a board at once, how often, and what that ties to the reference.
#pragma once

#include <cstddef>
#include <vector>

#include "server/calib/placement/planned_rig.h"

namespace rigcal::calib::placement {

class PairTies {
 public:
  // No capture yet, of so many cameras.
  explicit PairTies(std::size_t cameras) : cameras_(cameras), together_(cameras * cameras, 0) {}
  // Every two that look at its board are together once more.
  void Add(const PlannedCapture& capture);
  // So many captures both of them see the board of.
  [[nodiscard]] int Together(std::size_t a, std::size_t b) const { return together_[a * cameras_ + b]; }
  // Per camera: the most captures, up to `wanted`, that every pair on some way to the reference has; `wanted` of the
  // reference itself, 0 of one that nothing leads to.
  [[nodiscard]] std::vector<int> TiedBy(std::size_t reference, int wanted) const;

 private:
  std::size_t cameras_;
  std::vector<int> together_;
};

}  // namespace rigcal::calib::placement
