// Degrees of freedom behind a sum of independent covariances, of which some are estimated.
#pragma once

#include "server/math/covariance.h"

namespace rigcal {

// Krishnamoorthy & Yu 2004 (the modified Nel & Van der Merwe formula): with parts S_i of n_i degrees of freedom in
// S = sum of all parts, of dimension p, nu = p (p + 1) / sum_i [tr((S_i S^-1)^2) + tr(S_i S^-1)^2] / n_i. It does not
// change with the frame, and for one part alone it is n. With nu, T^2 = e^T S^-1 e is Hotelling's. Parts that are known
// exactly are in S only.
class PooledDof {
 public:
  // `part` symmetric, dof > 0.
  void Add(const Matrix6d& part, int dof);
  // 0: nothing is estimated, or `sum` has no direction. Where `sum` is singular, over the directions that it has.
  [[nodiscard]] double Of(const Matrix6d& sum) const;

 private:
  Eigen::Matrix<double, 36, 36> products_ = Eigen::Matrix<double, 36, 36>::Zero();  // sum of vec(S_i) vec(S_i)^T / n_i
};

}  // namespace rigcal
