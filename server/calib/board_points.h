// A checkerboard's corners in its own frame.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/model/session.h"

namespace rigcal::calib {

// Row-major, column fastest, z = 0; in metres.
[[nodiscard]] std::vector<Eigen::Vector3d> BoardPoints(const Checkerboard& board);

}  // namespace rigcal::calib
