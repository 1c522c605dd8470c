// Degrees of freedom behind a sum of independent covariances, of which some are estimated.
#pragma once

#include "server/math/covariance.h"

namespace rigcal {

// Krishnamoorthy & Yu 2004 (the modified Nel & Van der Merwe formula): with parts S_i of n_i degrees of freedom in
// S = sum of all parts, of dimension p, nu = p (p + 1) / sum_i V_i, where V_i = [tr((S_i S^-1)^2) + tr(S_i S^-1)^2] /
// n_i is what a Wishart matrix scatters by: E |S^-1/2 (S_i - E S_i) S^-1/2|^2. It does not change with the frame, and
// for one part alone it is n. With nu, T^2 = e^T S^-1 e is Hotelling's. Parts that are known exactly are in S only.
class PooledDof {
 public:
  // `rough`: a covariance about as large as the sum, by which the numbers are scaled before they are multiplied; it
  // does not change the answer. Not positive definite: none.
  explicit PooledDof(const Matrix6d& rough = Matrix6d::Identity());
  // `part` symmetric, dof > 0; else it counts as known.
  void Add(const Matrix6d& part, int dof);
  // A part that is the sum of c c^T over `columns`, independent blocks (zero: a block that says nothing here) of which
  // some may carry more than others: what all such terms themselves scatter by takes the place of the sum of their V_i,
  // if it is more.
  void AddBlocks(const Eigen::Matrix<double, 6, Eigen::Dynamic>& columns, int dof);
  // 0: nothing is estimated, or `sum` has no direction. Where `sum` is singular, over the directions that it has.
  [[nodiscard]] double Of(const Matrix6d& sum) const;

 private:
  using Products = Eigen::Matrix<double, 36, 36>;
  Matrix6d scale_;                                                  // rough = scale^-1 scale^-T
  Products others_ = Products::Zero(), blocks_ = Products::Zero();  // sums of vec(S_i) vec(S_i)^T / n_i
  Products terms_ = Products::Zero(), sums_ = Products::Zero();     // of the blocks' terms, and of their sums
};

}  // namespace rigcal
