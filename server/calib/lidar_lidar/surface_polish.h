// The polish after NDT: generalised ICP (Segal et al. 2009) of two clouds' pieces of surface, with a robust kernel.
#pragma once

#include <vector>

#include "server/calib/lidar_lidar/ndt_fit.h"
#include "server/calib/lidar_lidar/surface_cells.h"

namespace rigcal::calib {

// Clouds of one capture.
struct PolishTerm {
  const SurfaceCells *a = nullptr, *b = nullptr;
  // Only those of b's cells that are in this half of blocks, like the black or the white squares of a board; below
  // zero: all of them.
  int half = -1;
  double block_m = 1;
};
struct Polished {
  Se3 T_a_b;
  double last_step = 0;  // as NdtFit's
  int iterations = 0;
  bool converged = false;
};
// Gauss-Newton sums of one capture at a pose, for T_a_b * Exp(xi).
struct NormalSums {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
};
[[nodiscard]] NormalSums SumsOf(const PolishTerm& term, const Se3& T_a_b);

// From the pose of NDT; `locked` as for FitNdt. The same bits on any number of threads.
[[nodiscard]] Polished Polish(const std::vector<PolishTerm>& terms, const Se3& start,
                              const Directions& locked = Directions(6, 0));

}  // namespace rigcal::calib
