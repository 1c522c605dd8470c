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

// The same of several poses at once, six rows each: one sensor may scatter more than the model says while others do as
// it says, so each has a factor of its own, f_s = tr(M_ss^-1 (L S L^T)_ss) / 6, with M = L L^T the model's covariance.
// They are drawn towards their mean by as much as chance makes them unlike (a mean square of G blocks has the variance
// f^2 / (3 G); James & Stein 1961), then held at 1 or more; S is shrunk towards L^-1 F^1/2 M F^1/2 L^-T. Noise is of G
// terms about their mean, hence times G / (G - 1). Either is taken for chance up to what chance makes in 95 of 100
// cases: as nothing may fall below the model, whatever else is believed of chance only widens. `mean` is that of all.
[[nodiscard]] ShrunkScatter ShrinkScatterOfPoses(const Eigen::MatrixXd& y, const Eigen::MatrixXd& L,
                                                 const Eigen::MatrixXd& known = {});

}  // namespace rigcal
