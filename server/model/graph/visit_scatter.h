// How a sensor's place scatters from visit to visit, as its own robot's visits tell it and as those of the other robots
// of the rig model do.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "server/base/ids.h"
#include "server/math/tangent.h"

namespace rigcal {

using ThreeAxes = std::array<double, 3>;

// Of three axes together: shifts (m^2) or turns (rad^2), mean variance of an axis.
struct ScatterOfAxes {
  double between =
      0.0;           // beyond what the visits err by; of a robot's own below zero where they agree better than they say
  double own = 0.0;  // what the visits themselves err by, on average
  double dof = 0.0;  // behind the sum of both, which is what the visits show
  // Of a robot's own: what is shown along each axis over what it would show if all were alike. Of a pool: what is
  // `between` along each over the mean. Zeros: not told, and taken as alike. A sensor that hangs on one screw scatters
  // about one axis.
  ThreeAxes ratio = {};
  // What visits scatter by in all, m^2 or rad^2: beyond their own uncertainty and by it; never below zero.
  [[nodiscard]] double Shown() const { return std::max(0.0, between + own); }
  // Whether it says how unlike the three axes are.
  [[nodiscard]] bool TellsAxes() const { return ratio[0] > 0 && ratio[1] > 0 && ratio[2] > 0; }
  bool operator==(const ScatterOfAxes&) const = default;
};

// The mean `between` where that of each axis is its `share` (mean one) of it, weighted as of a `between` of about so
// much: v = sum w_a (shown_a - own) / share_a / sum w_a, w_a = (share_a / t_a)^2, t_a = between share_a + own; and dof
// / 3 sum w_a / max w_a degrees of freedom, those of the axis that tells most: of three axes that are alike, of one
// where one has all. As it stands where it does not tell its axes.
[[nodiscard]] ScatterOfAxes InShares(const ThreeAxes& share, double between, const ScatterOfAxes& scatter);

struct VisitScatter {
  ScatterOfAxes translation, rotation;
  int robots = 1;  // that tell it
  bool operator==(const VisitScatter&) const = default;
};
// By sensor; of the robots of one rig model that have one reference.
using PooledScatter = std::map<SensorId, VisitScatter>;

// What is taken for the scatter, and the degrees of freedom that stand behind it: 0, nothing tells it.
struct ScatterTaken {
  double variance = 0.0, dof = 0.0;
  bool by_pool = false;
  ThreeAxes share = {1.0, 1.0, 1.0};  // of each axis: its variance over the mean

  // One variance for all three: what is taken where nobody tells them apart.
  [[nodiscard]] bool AxesAreAlike() const { return share == ThreeAxes{1.0, 1.0, 1.0}; }
};
// The mean of the posterior of a variance whose prior is a scaled inverse chi-square: (nu s^2 + nu_0 v_0) / (nu +
// nu_0), of nu + nu_0 degrees of freedom. nu_0 is that of the pool's sum, so it is less for a robot whose visits err by
// less than those of the pool. A robot that shows so much more than its pool that one in twenty would do so by chance
// is taken by itself. How unlike axes are is the pool's word (its `ratio`), whose `dof` may be 0: then that is all it
// tells. `own` of no visits, or of one: dof 0, and `own.own` what the one errs by. Never below zero.
//
// Where no other robot tells it, nor along which axes, few visits do not tell either whether one axis has all of it. So
// each axis goes by what it shows itself, nu = visits - 1, and by what the axes of the robot show on the whole, which
// counts as few numbers: v_a = (nu (ratio_a shown - own) + nu_0 v_0) / (nu + nu_0), of nu + nu_0 degrees of freedom,
// nu_0 = 2 - 1 / S of S sensors, v_0 + own the geometric mean of their `between` + own. With more numbers, or an
// arithmetic mean, a robot of whose sensors one is loose along one axis would be accused for it (server/fleet/README.md
// has the figures). `of_robot`: all of the robot's sensors, this one too; empty: this one alone.
[[nodiscard]] ScatterTaken TakenScatter(const ScatterOfAxes& own, const std::optional<ScatterOfAxes>& pooled,
                                        const std::vector<ScatterOfAxes>& of_robot = {});

// Variance along the six axes of a tangent.
[[nodiscard]] Vector6d AlongAxes(const ScatterTaken& translation, const ScatterTaken& rotation);

// Behind what is taken for the scatter of shifts and of turns; 0: nothing tells it.
struct ScatterDof {
  double translation = 0.0, rotation = 0.0;
  bool operator==(const ScatterDof&) const = default;
};

}  // namespace rigcal
