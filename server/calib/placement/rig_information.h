// What captures of a carried board say together of where the cameras of a rig sit: the information of the joint problem
// (server/calib/joint/README.md), boards eliminated, at one state and before anything is estimated.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "server/calib/placement/planned_rig.h"
#include "server/math/tangent.h"

namespace rigcal::calib::placement {

// What a drawing, or a guess, is good for: without captures no pose is known better, in any axis.
inline constexpr double kGuessSigma_m = 0.3, kGuessSigma_rad = 0.3;

// Where the unknowns stand: six numbers of each camera's pose (right tangent; none of the reference: -1), then the
// numbers of each lens that are not held.
struct UnknownsOfRig {
  std::vector<int> pose;               // per camera, the first of six
  std::vector<std::vector<int>> lens;  // per camera, of each intrinsic; -1: held
  int size = 0;
  // In the order of the rig's cameras, all poses before all lenses.
  explicit UnknownsOfRig(const PlannedRig& rig);
};

// Symmetric, positive semidefinite, over some of the unknowns; m, rad and the units of the intrinsics, to the power -2.
struct PartOfInformation {
  std::vector<int> unknowns;  // different ones, as UnknownsOfRig counts them
  Eigen::MatrixXd H;          // rows and columns in their order
};

// Of one capture, the board's pose eliminated. A look that its camera cannot have says nothing; a single look says
// nothing of poses, and of the lens what the pose leaves.
[[nodiscard]] PartOfInformation InformationOf(const PlannedRig& rig, const UnknownsOfRig& unknowns,
                                              const PlannedCapture& capture);
// The same of a capture that is only thought of: every point of the board, as the nine that have its moments up to the
// third along either side.
[[nodiscard]] PartOfInformation ExpectedInformation(const PlannedRig& rig, const UnknownsOfRig& unknowns,
                                                    const PlannedCapture& capture);

// Covariance of the unknowns by all of `parts` and what is known beforehand: kGuessSigma of poses, lens_sigma.
[[nodiscard]] Eigen::MatrixXd CovarianceBy(const PlannedRig& rig, const UnknownsOfRig& unknowns,
                                           std::span<const PartOfInformation> parts);
// The variances of the first `count` unknowns once `part` is added, by an update of its size: C - C_J (I + H C_JJ)^-1 H
// C_J^T (Woodbury). No variance grows.
[[nodiscard]] Eigen::VectorXd VariancesWith(const Eigen::MatrixXd& covariance, const PartOfInformation& part,
                                            int count);

}  // namespace rigcal::calib::placement
