#include "server/calib/placement/poses_so_far.h"

#include <algorithm>
#include <cmath>

#include "server/calib/core/diagnoses.h"

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

// Above 1 until a pair has captures enough for its sigma to be believed; far above while it has no pose at all.
double ByCaptures(int shared) {
  const int lacking = static_cast<int>(kCapturesEnough) - shared;
  if (lacking <= 0) return 0.0;
  return shared < kSharedCapturesMin ? 1.0 + (kSharedCapturesMin - shared) : 1.0 + kMissingOfACapture * lacking;
}

}  // namespace

std::vector<PoseSoFar> PosesBy(const PlannedRig& rig, const UnknownsOfRig& unknowns, const Eigen::VectorXd& variances,
                               const PairTies& ties) {
  const std::vector<int> tied = ties.TiedBy(rig.reference, static_cast<int>(kCapturesEnough));
  std::vector<PoseSoFar> poses(rig.cameras.size());
  for (std::size_t c = 0; c < poses.size(); ++c) {
    PoseSoFar& pose = poses[c];
    pose.tied_by = tied[c];
    if (unknowns.pose[c] >= 0) SetPose(rig.cameras[c], variances, unknowns.pose[c], pose);
    if (const int focal = unknowns.lens[c].front(); focal >= 0)
      pose.focal_sigma_ratio = kMoreThanCorners_ratio * std::sqrt(variances[focal]) / rig.cameras[c].intrinsics[0];
    pose.sigma_of_tolerance = std::max(pose.pose_of_tolerance, pose.focal_sigma_ratio / kFocalSigmaMax_ratio);
    pose.of_tolerance = std::max(pose.sigma_of_tolerance, ByCaptures(pose.tied_by));
  }
  return poses;
}

double MissingOf(const PoseSoFar& pose) {
  const int lacking = std::max(static_cast<int>(kCapturesEnough) - pose.tied_by, 0);
  return pose.sigma_of_tolerance * pose.sigma_of_tolerance + kMissingOfACapture * lacking;
}

double MissingOf(const std::vector<PoseSoFar>& poses, const std::vector<std::size_t>& left_out) {
  double sum = 0;
  for (std::size_t c = 0; c < poses.size(); ++c)
    if (!std::binary_search(left_out.begin(), left_out.end(), c)) sum += MissingOf(poses[c]);
  return sum;
}

}  // namespace rigcal::calib::placement
