// How a sensor's place scatters from visit to visit, as its own robot's visits tell it and as those of the other robots of the
// rig model do.
#pragma once

#include <algorithm>
#include <map>
#include <optional>

#include "server/base/ids.h"

namespace rigcal {

// Of three axes that are taken as alike: shifts (m^2) or turns (rad^2), variance per axis.
struct ScatterOfAxes {
  double between = 0.0;  // beyond what the visits err by; of a robot's own below zero where they agree better than they say
  double own = 0.0;      // what the visits themselves err by, on average
  double dof = 0.0;      // behind the sum of both, which is what the visits show
  [[nodiscard]] double Shown() const { return std::max(0.0, between + own); }
  bool operator==(const ScatterOfAxes&) const = default;
};

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
};
// The mean of the posterior of a variance whose prior is a scaled inverse chi-square: (nu s^2 + nu_0 v_0) / (nu + nu_0), of
// nu + nu_0 degrees of freedom. nu_0 is that of the pool's sum, so it is less for a robot whose visits err by less than those
// of the pool. A robot that shows so much more than its pool that one in twenty would do so by chance is taken by itself.
// `own` of no visits, or of one: dof 0, and `own.own` what the one errs by. Never below zero.
[[nodiscard]] ScatterTaken TakenScatter(const ScatterOfAxes& own, const std::optional<ScatterOfAxes>& pooled);

// Behind what is taken for the scatter of shifts and of turns; 0: nothing tells it.
struct ScatterDof {
  double translation = 0.0, rotation = 0.0;
  bool operator==(const ScatterDof&) const = default;
};

}  // namespace rigcal
