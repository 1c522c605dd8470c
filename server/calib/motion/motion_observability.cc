#include "server/calib/motion/motion_observability.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "server/calib/core/wording.h"

namespace rigcal::calib {
namespace {

constexpr double kNumerical_rad = 1e-9, kNumerical_m = 1e-9;

// Turning about a line through `point` along `axis`, moving along it: of frame a, as a change of X on the left.
Vector6d TurnAbout(const Eigen::Vector3d& axis, const Eigen::Vector3d& point) {
  Vector6d twist;
  twist << point.cross(axis), axis;
  return twist;
}
Vector6d MoveAlong(const Eigen::Vector3d& axis) {
  Vector6d twist;
  twist << axis, Eigen::Vector3d::Zero();
  return twist;
}

// Exp(s) X = X Exp(Ad(X^-1) s).
void SetOpen(const std::vector<Vector6d>& twists_a, const Se3& X, MotionReach& reach) {
  const auto count = static_cast<Eigen::Index>(twists_a.size());
  reach.open.resize(6, count);
  for (Eigen::Index i = 0; i < count; ++i)
    reach.open.col(i) = Adjoint(X.Inverse()) * twists_a[static_cast<std::size_t>(i)];
  const SplitDirections split = SplitBy(reach.open);
  reach.open = split.within;
  reach.free = split.across;
}

Eigen::Matrix3d MeanRotation(const std::vector<Se3>& poses) {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (const Se3& T : poses) mean += T.R() / static_cast<double>(poses.size());
  return mean;
}

// How much, by rms over the poses, the point of the body moves across the axis that moves least; and that point.
double LeastTravel(const std::vector<Se3>& poses, const Eigen::Vector3d& axis_world, const Eigen::Vector3d& axis_a,
                   Eigen::Vector3d& point_a_m) {
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis_world * axis_world.transpose();
  const Eigen::Matrix3d mean_R = MeanRotation(poses);
  Eigen::Vector3d mean_p = Eigen::Vector3d::Zero();
  for (const Se3& T : poses) mean_p += T.p_m / static_cast<double>(poses.size());
  Eigen::Matrix3d normal =
      axis_a * axis_a.transpose();  // the point may slide along the axis: the nearest to a's origin
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Se3& T : poses) {
    const Eigen::Matrix3d M = across * (T.R() - mean_R);
    normal += M.transpose() * M;
    right -= M.transpose() * (across * (T.p_m - mean_p));
  }
  point_a_m = normal.ldlt().solve(right);
  double sum_m2 = 0;
  for (const Se3& T : poses) sum_m2 += (across * ((T.R() - mean_R) * point_a_m + T.p_m - mean_p)).squaredNorm();
  return std::sqrt(sum_m2 / static_cast<double>(poses.size()));
}

void ReachWithoutRotation(const std::vector<Se3>& poses, const Se3& X, const MotionNoise& noise, MotionReach& reach) {
  const Eigen::Matrix3d to_a = Eigen::Quaterniond(poses.front().q).conjugate().toRotationMatrix();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Se3& T : poses) mean += T.p_m / static_cast<double>(poses.size());
  for (const Se3& T : poses) scatter += (T.p_m - mean) * (T.p_m - mean).transpose() / static_cast<double>(poses.size());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(scatter, Eigen::ComputeFullU);
  const double least_m = std::max(noise.noises * noise.translation_m, kNumerical_m);
  const Eigen::Vector3d ways_m = svd.singularValues().cwiseSqrt();
  reach.axis_a = to_a * svd.matrixU().col(0);
  reach.travel_m = ways_m[0];
  std::vector<Vector6d> open;
  for (int i = 0; i < 3; ++i) open.push_back(MoveAlong(Eigen::Vector3d::Unit(i)));
  reach.kind = MotionKind::kNoRotation;
  if (ways_m[1] < least_m) {
    reach.kind = MotionKind::kOneLine;
    open.push_back(TurnAbout(reach.axis_a, Eigen::Vector3d::Zero()));
  }
  if (ways_m[0] < least_m) reach.kind = MotionKind::kStill;
  SetOpen(open, X, reach);
}

}  // namespace

// The mean of the rotation matrices has one singular value per axis: 1 - s^2 is the mean square by which the axis
// leaves its mean direction, whatever turns there are about it.
MotionReach ObservableByMotion(const std::vector<Se3>& T_world_a, const Se3& X, const MotionNoise& noise) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(MeanRotation(T_world_a), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d s = svd.singularValues();
  const auto beyond = [](double value) { return std::sqrt(std::max(0.0, 1 - value * value)); };
  MotionReach reach;
  reach.axis_a = svd.matrixV().col(0);
  reach.tilt_noise_rad = std::sqrt(2.0) * noise.rotation_rad;
  // What noise alone adds to both is taken off.
  const auto without_noise = [&](double rms, double noise_rad) {
    return std::sqrt(std::max(0.0, rms * rms - noise_rad * noise_rad));
  };
  reach.tilt_rad = without_noise(beyond(s[0]), reach.tilt_noise_rad);
  reach.turn_rad = without_noise(beyond(s[1]), reach.tilt_noise_rad);
  const double least_rad = std::max(noise.noises * reach.tilt_noise_rad, kNumerical_rad);
  if (reach.turn_rad < least_rad) {
    ReachWithoutRotation(T_world_a, X, noise, reach);
    return reach;
  }
  if (reach.tilt_rad >= least_rad) {
    SetOpen({}, X, reach);
    return reach;
  }
  // Eigen gives U and V the same sign per column: both are the axis, in the world and in a.
  reach.travel_m = LeastTravel(T_world_a, svd.matrixU().col(0), reach.axis_a, reach.point_a_m);
  const double least_m = std::max(noise.noises * std::sqrt(2.0) * noise.translation_m, kNumerical_m);
  std::vector<Vector6d> open = {MoveAlong(reach.axis_a)};
  reach.kind = MotionKind::kOneAxis;
  if (without_noise(reach.travel_m, std::sqrt(2.0) * noise.translation_m) < least_m) {
    reach.kind = MotionKind::kOnTheSpot;
    open.push_back(TurnAbout(reach.axis_a, reach.point_a_m));
  }
  SetOpen(open, X, reach);
  return reach;
}

MotionWords WordsOf(const MotionReach& motion, const std::string& axis) {
  const auto degrees = [](double angle_rad) { return Formatted("%.2f deg", angle_rad * 180 / M_PI); };
  const std::string tilt =
      Worded("to within {} (noise {})", {degrees(motion.tilt_rad), degrees(motion.tilt_noise_rad)});
  switch (motion.kind) {
    case MotionKind::kOneAxis:
      return {"planar_motion", "turned about one axis only, " + axis + ", " + tilt, 1, kTurnMore};
    case MotionKind::kOnTheSpot:
      return {"turning_on_the_spot", "turned about one fixed line only, along " + axis + ", " + tilt, 2,
              std::string(kDriveElsewhere) + kTurnMore};
    case MotionKind::kNoRotation:
      return {"pure_translation", "moved but not turned", 3, kTurnMore};
    case MotionKind::kOneLine:
      return {"straight_line", "moved along one line only, " + axis + ", and not turned", 4, kTurnMore};
    case MotionKind::kGeneral:
    case MotionKind::kStill:
      break;
  }
  return {{}, {}, 0, kTurnMore};
}

}  // namespace rigcal::calib
