// How well the poses of a rig would be known by what was seen so far, against how well they have to be.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/calib/placement/pair_ties.h"
#include "server/calib/placement/rig_information.h"

namespace rigcal::calib::placement {

// What a capture that lacks counts among what is missing, where a pose that is known to its tolerance counts 1.
inline constexpr double kMissingOfACapture = 0.05;
// Of a focal length that is estimated, 1 sigma: the default tolerance of a pose at a metre, as `rigcal check` has it.
inline constexpr double kFocalSigmaMax_ratio = 0.005;

// What is expected of the joint refinement over the root of the inverse information: its groups of captures scatter by
// more than corners alone (server/calib/joint/README.md, covariance).
inline constexpr double kMoreThanCorners_ratio = 1.3;

struct PoseSoFar {
  // Of the right tangent, m and rad, kMoreThanCorners_ratio included; of the reference 0.
  Vector6d sigma = Vector6d::Zero();
  double pose_of_tolerance = 0.0;  // its worst axis over the tolerance: 1 and less will do
  int worst_axis = 0;              // of `sigma`
  double focal_sigma_ratio = 0.0;  // on the axis where the lens is not held; else 0
  int tied_by = 0;  // captures of the weakest pair on the best way to the reference, up to kCapturesEnough
  // The largest of: the pose's, the focal length's over its limit, and what tied_by lacks (above 1 while it lacks any:
  // from fewer captures than kCapturesEnough the server does not say how sure it is).
  double of_tolerance = 0.0;
  double sigma_of_tolerance = 0.0;  // the same without what tied_by lacks
};

// Per camera of the rig, by the variances of all unknowns and by who saw boards at once.
[[nodiscard]] std::vector<PoseSoFar> PosesBy(const PlannedRig& rig, const UnknownsOfRig& unknowns,
                                             const Eigen::VectorXd& variances, const PairTies& ties);
// What is missing of one pose: the square of sigma_of_tolerance, which captures divide, and a little for every capture
// that tied_by lacks: sigmas come before.
[[nodiscard]] double MissingOf(const PoseSoFar& pose);
// The sum over the cameras but for those of `left_out`, ascending: what nothing can reach would hide what the rest
// gains.
[[nodiscard]] double MissingOf(const std::vector<PoseSoFar>& poses, const std::vector<std::size_t>& left_out);

}  // namespace rigcal::calib::placement
