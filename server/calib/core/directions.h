// Directions of a pose: columns in its right tangent.
#pragma once

#include <Eigen/QR>

#include "server/math/tangent.h"

namespace rigcal::calib {

using Directions = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Orthonormal: a basis of what `spanned` spans, and of all that is orthogonal to it.
struct SplitDirections {
  Directions within, across;
};
// The columns of `spanned` have to be independent; none at all is allowed.
[[nodiscard]] inline SplitDirections SplitBy(const Directions& spanned) {
  const Eigen::Index count = spanned.cols();
  const Matrix6d Q =
      count == 0 ? Matrix6d::Identity() : Matrix6d(Eigen::HouseholderQR<Directions>(spanned).householderQ());
  return {Q.leftCols(count), Q.rightCols(6 - count)};
}

}  // namespace rigcal::calib
