// A scatter estimated from few independent terms, held against what a model says of it.
#pragma once

#include <Eigen/Core>

namespace rigcal {

// Linear shrinkage of S = sum y y^T + known towards f I, f = max(1, tr S / d), by as much as the terms themselves
// scatter (Ledoit & Wolf 2004); then along every axis no less than 1, what the model says.
struct ShrunkScatter {
  Eigen::MatrixXd S;
  double model_ratio = 1.0;  // what f I makes of it
  double mean = 1.0;         // tr S / d before: how many times as large as the model
};
// Columns y: independent terms in coordinates in which the model's covariance is the identity; `known` in the same, or
// empty.
[[nodiscard]] ShrunkScatter ShrinkScatter(const Eigen::MatrixXd& y, const Eigen::MatrixXd& known = {});

}  // namespace rigcal
