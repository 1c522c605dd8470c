// Robots on which a sensor sits elsewhere than on the others, by more than chance.
//
// 1. Robots far from the medians of the axes, in robust spreads, are set aside: they must not hide each other. The
// limit is
//    Student's t for the few degrees of freedom that a robust spread of n values has (0.37 n, its efficiency), so that
//    chance alone hardly ever sets one aside. Among fewer than ten none is: a median distance of so few is often tiny
//    by chance.
// 2. Each robot is held against mean and covariance S of the m others that were not set aside:
//      D^2 = d^T (S (1 + 1/m) + C)^-1 d,   C: how well its own pose is known.
//    With C = 0 and normal places, D^2 (m - 6) / (6 (m - 1)) is F(6, m - 6): Mahalanobis' distance with an estimated
//    covariance (Hotelling). Where all were known exactly it would be chi-square with six degrees of freedom.
// 3. Where m < 18, three others per axis, S tells too little: then each axis by itself, d_k^2 / (S_kk (1 + 1/m) + C_kk)
// is
//    F(1, m - 1), and the odds of the least likely axis count six times (Bonferroni).
// C only widens: a pose that is known badly is no outlier.
#pragma once

#include <vector>

#include "server/math/tangent.h"

namespace rigcal::fleet {

inline constexpr std::size_t kOthersForDistance = 18;

struct Distance {
  double odds = 1.0;           // of so large a distance by chance
  std::size_t worst_axis = 0;  // x y z rx ry rz: the least likely by itself
};
// Of each robot, in their order. `offsets` and `covariances` (right tangents, m and rad) have one row per robot, five
// or more. A covariance that is no number accuses nobody.
[[nodiscard]] std::vector<Distance> DistancesFromOthers(const std::vector<Vector6d>& offsets,
                                                        const std::vector<Matrix6d>& covariances);
// Whether D^2 is asked, of so many robots of which none was set aside.
[[nodiscard]] bool IsByDistance(std::size_t robots);

}  // namespace rigcal::fleet
