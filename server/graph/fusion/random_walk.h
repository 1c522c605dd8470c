// A mount creeps, goes with the seasons, gives way by a little on every drive: its sensor's place goes from visit to
// visit and does not come back. What visits scatter by about one place does not tell it: they follow each other.
#pragma once

#include <vector>

#include "server/graph/fusion/session_fusion.h"

namespace rigcal::graph {

// How the place walks, variance per axis in a day, by what visits say of it one after the other (newest first): the
// random walk plus noise (Harvey 1989, Forecasting, structural time series models and the Kalman filter, 4.1.2), for
// each group of three axes.
//   place_k = place_k-1 + w_k, w_k ~ N(0, q dt_k);  e_k = place_k + b_k, b_k ~ N(0, own_k + v)
// Before the visits are asked the place is as likely to stay (q = 0) as to walk; every size of q is then as likely as
// another, by its logarithm, from nearly nothing of what the surest axis shows to four times what any shows beyond its
// own errors, over all their days; v likewise, or zero (a spike and a slab: Mitchell & Beauchamp 1988). What comes back
// is the mean after them, and as how many numbers tell a variance as surely: 2 mean^2 / variance. Zero for fewer than
// six visits, or of one day.
struct Walk {
  VisitVariance per_day;
  ScatterDof dof;
};
[[nodiscard]] Walk WalkOf(const std::vector<VisitResidual>& visits);

// Visits less where the sensor was on each, as far as the walk and the scatter tell (all visits at once, axis by axis):
// with R = diag(own_k + v), K_kl = q min(t_k, t_l) and M = (K + R)^-1, r = R P e, P = M - M 1 1^T M / 1^T M 1; of these
// sum r^2 / (own + v) is tr(R P) on average, visits less means. Without a walk the visits as they are, less one.
struct WalkResiduals {
  std::vector<VisitResidual> visits;
  MeansTaken means;
};
[[nodiscard]] WalkResiduals ResidualsAboutWalk(std::vector<VisitResidual> visits, const VisitVariance& per_day,
                                               const VisitVariance& scatter);

}  // namespace rigcal::graph
