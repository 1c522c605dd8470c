// The polish after NDT: generalised ICP (Segal et al. 2009) of two clouds' pieces of surface, with a robust kernel.
// Every cell of a cloud counts once, so that dense rows of points do not decide a normal.
#pragma once

#include <vector>

#include "server/calib/lidar_lidar/moment_grid.h"
#include "server/calib/lidar_lidar/ndt_fit.h"

namespace rigcal::calib {

// In the frame of its cloud, metres; the normal is unit, of either sign.
struct SurfaceCell {
  Eigen::Vector3d mean_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  bool has_normal = false;
};

struct SurfaceCells {
  double cell_m = 1;
  CellIndex index;
  std::vector<SurfaceCell> cells;  // by the index's numbers

  // The cell whose mean is nearest to q, among those that touch q's own; null: there is none.
  [[nodiscard]] const SurfaceCell* Nearest(const Eigen::Vector3d& q_m) const;
};

// A normal for each cell, from the means of the cells around it.
[[nodiscard]] SurfaceCells SurfaceCellsOf(const MomentGrid& grid);

// Clouds of one capture.
struct PolishTerm {
  const SurfaceCells *a = nullptr, *b = nullptr;
  // Only those of b's cells that are in this half of blocks, like the black or the white squares of a board; below
  // zero: all of them.
  int half = -1;
  double block_m = 1;
};
// T_a_b at the end, and whether it is the minimum: without `converged` it is only where the iterations ended.
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
// With pairs of nearest cells as they are at this pose.
[[nodiscard]] NormalSums SumsOf(const PolishTerm& term, const Se3& T_a_b);

// From the pose of NDT; `locked` as for FitNdt. The same bits on any number of threads.
[[nodiscard]] Polished Polish(const std::vector<PolishTerm>& terms, const Se3& start,
                              const Directions& locked = Directions(6, 0));

}  // namespace rigcal::calib
