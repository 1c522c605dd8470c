// Where sensors are on the next visit, as the fused ones tell it: the covariance, and the degrees of freedom behind it.
#pragma once

#include <vector>

#include "server/graph/fusion/session_fusion.h"

namespace rigcal::graph {

// Per sensor, behind what was taken for them; 0: known, or there is none.
struct FusionDof {
  std::vector<ScatterDof> scatter, walk;
};
struct NextVisit {
  Eigen::MatrixXd covariance;  // of the poses, rows of the sensors
  std::vector<double> dof;     // per sensor
};
// `inverse` of Settle. What errs alike on every visit does not fall with their number; the scatter of one visit, and
// the walk until then (DaysUntilNext), come on top.
[[nodiscard]] NextVisit NextVisitOf(const SessionFusion& fusion, const Eigen::MatrixXd& inverse, const FusionDof& dof);

}  // namespace rigcal::graph
