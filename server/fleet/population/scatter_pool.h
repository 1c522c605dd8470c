// What the robots of a rig model scatter by from visit to visit, as a prior for one more of them.
//
// Each robot's visits show a variance s^2 (visit_scatter.h) of nu degrees of freedom about that robot's own, and the
// robots' own are taken as a scaled inverse chi-square of nu_0 about v_0, both by moments of log s^2 (Smyth, Stat.
// Appl. Genet. Mol. Biol. 3(1), 2004): with z = log s^2 - LogVarianceBias(nu),
//   trigamma(nu_0 / 2) = Var z - mean trigamma(nu / 2)  and  log v_0 = mean z + LogVarianceBias(nu_0).
// Robots that scatter differently give a small nu_0, and a pool that says little. So that a few robots do not pass for
// alike by chance,
//   - Var z is the bound that it exceeds in nine of ten samples only if it is that large: (R - 1) Var z / chi^2_.1(R -
//   1),
//   - nu_0 is at most the degrees of freedom of all robots together, and at most kPoolDofMax,
//   - nu_0 is so small that the robot that shows most beyond v_0 is no stranger in a sample of R.
// Where nu_0 is then below kPoolDofMin, the pool tells nothing of how much they scatter.
//
// Along which axes they scatter is a sensor's mount, and alike on all of them. ratio_a = exp(k (z_a - mean z)) of mean
// one, z_a the mean of log ratio_a over the robots, each by 1 / trigamma(m / 2), m = nu / 3 of one axis (what it is too
// small by is the same of all axes). k = 1 - c / Var z, at least zero, shrinks what chance makes, c = 1 / sum of the
// weights, towards axes that are alike (Efron & Morris 1973). Of what they scatter by, an axis has the share (v + own)
// ratio_a - own of the mean, v and own means over the robots. All the above is then of v by these shares, with the
// degrees of freedom that it then has (InShares). What an axis scatters by is v_0 times its share, and no surer than
// both: trigamma(nu_0 / 2) grows by c. Without that few robots, whose shares may be anything by chance, would be taken
// at their word. Where they tell no scale, shares of which c is that of less than kAxesDofMin are not told either.
//
// Robots of two visits do not count: of those, the ones that scatter most are told to have moved
// (FindMovesBetween knows no scatter yet) and are not here, and what is left scatters too little.
#pragma once

#include <vector>

#include "server/model/graph/visit_scatter.h"

namespace rigcal::fleet {

inline constexpr double kPoolDofMax = 200.0, kPoolDofMin = 6.0, kAxesDofMin = 20.0;

// Of one robot, by sensor: all of robots with the same reference.
using RobotScatter = std::map<SensorId, VisitScatter>;

// Of the sensors that at least kPopulationMin of `robots` tell by three visits or more, and whose pools tell something
// of shifts and of turns. The robot for which it is meant must not be among them. Same robots in the same order, same
// numbers.
[[nodiscard]] PooledScatter PoolScatter(const std::vector<RobotScatter>& robots);

}  // namespace rigcal::fleet
