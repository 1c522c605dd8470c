// A cloud as small pieces of surface: the mean of each cell's points and the normal of the means around it. What the
// polish pairs with each other. Every cell counts once, so that dense rows of points do not decide a normal.
#pragma once

#include <vector>

#include "server/calib/lidar_lidar/moment_grid.h"

namespace rigcal::calib {

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

[[nodiscard]] SurfaceCells SurfaceCellsOf(const MomentGrid& grid);

}  // namespace rigcal::calib
