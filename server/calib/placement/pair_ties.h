// Which cameras saw a board at once, how often, and what that ties to the reference.
#pragma once

#include <cstddef>
#include <vector>

#include "server/calib/placement/planned_rig.h"

namespace rigcal::calib::placement {

// Captures that a pair must share for the server to have a pose of it at all (model/edges/method.h).
inline constexpr int kSharedCapturesMin = 3;

// A pair of cameras that others tie as well, with too few captures to be tested against them.
struct UntestedPair {
  std::size_t a = 0, b = 0;
  int lacking = 0;  // captures, above 0
};

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

  // Of the rig's pairs those in a loop that lack captures to be tested.
  [[nodiscard]] std::vector<UntestedPair> Untested(const PlannedRig& rig) const;

 private:
  std::size_t cameras_;
  std::vector<int> together_;
};

}  // namespace rigcal::calib::placement
