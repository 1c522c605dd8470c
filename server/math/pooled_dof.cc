#include "server/math/pooled_dof.h"

namespace rigcal {

void PooledDof::Add(const Matrix6d& part, int dof) {
  const auto entries = part.reshaped();
  products_ += entries * entries.transpose() / dof;
}

double PooledDof::Of(const Matrix6d& sum) const {
  const ObservableSubspace inverse = Observable(sum);
  const Matrix6d& W = inverse.covariance;
  double shares = W.reshaped().dot(products_ * W.reshaped());  // squared traces
  for (int row = 0; row < 6; ++row)                            // traces of squares, by W (x) W
    for (int col = 0; col < 6; ++col)
      shares += W(row, col) * products_.block<6, 6>(6 * row, 6 * col).cwiseProduct(W).sum();
  return shares > 0.0 ? inverse.rank * (inverse.rank + 1) / shares : 0.0;
}

}  // namespace rigcal
