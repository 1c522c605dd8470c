#include "server/calib/placement/poses_so_far.h"

#include <algorithm>
#include <cmath>

namespace rigcal::calib::placement {
namespace {

void SetPose(const PlannedCamera& camera, const Eigen::VectorXd& variances, int at, PoseSoFar& pose) {
  for (int axis = 0; axis < 6; ++axis) {
    pose.sigma[axis] = kMoreThanCorners_ratio * std::sqrt(variances[at + axis]);
    const double over = pose.sigma[axis] / (axis < 3 ? camera.tolerance.m : camera.tolerance.rad);
    if (over <= pose.pose_of_tolerance) continue;
    pose.pose_of_tolerance = over;
    pose.worst_axis = axis;
  }
}

}  // namespace

std::vector<PoseSoFar> PosesBy(const PlannedRig& rig, const UnknownsOfRig& unknowns, const Eigen::VectorXd& variances,
                               const PairTies& ties) {
  const std::vector<int> tied = ties.TiedBy(rig.reference, kSharedCapturesMin);
  std::vector<PoseSoFar> poses(rig.cameras.size());
  for (std::size_t c = 0; c < poses.size(); ++c) {
    PoseSoFar& pose = poses[c];
    pose.tied_by = tied[c];
    if (unknowns.pose[c] >= 0) SetPose(rig.cameras[c], variances, unknowns.pose[c], pose);
    if (const int focal = unknowns.lens[c].front(); focal >= 0)
      pose.focal_sigma_ratio = kMoreThanCorners_ratio * std::sqrt(variances[focal]) / rig.cameras[c].intrinsics[0];
    const int lacking = kSharedCapturesMin - pose.tied_by;
    pose.of_tolerance = std::max(
        {pose.pose_of_tolerance, pose.focal_sigma_ratio / kFocalSigmaMax_ratio, lacking > 0 ? 1.0 + lacking : 0.0});
  }
  return poses;
}

double SumOf(const std::vector<PoseSoFar>& poses, const std::vector<std::size_t>& left_out) {
  double sum = 0;
  for (std::size_t c = 0; c < poses.size(); ++c)
    if (!std::binary_search(left_out.begin(), left_out.end(), c)) sum += std::pow(poses[c].of_tolerance, 4);
  return sum;
}

}  // namespace rigcal::calib::placement
