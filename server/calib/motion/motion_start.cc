#include "server/calib/motion/motion_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>

namespace rigcal::calib {
namespace {

constexpr double kNearlyHalfTurn_rad = 3.0;  // beyond, noise may flip a rotation vector
constexpr double kOneAxisRatio = 0.15;       // second singular value over the first
constexpr double kRotations_rad2 = 1e-8;     // mean square below: there are no rotations
constexpr double kWeakShare = 1e-4;          // of the translation's normal matrix: left at its shortest
constexpr int kTurns = 8;

Eigen::Vector3d RotationOf(const Se3& T) { return T.Log().tail<3>(); }

// Adds R, and, where `sum` tells one direction only, the same turned about that direction.
void AddRotations(const Eigen::Matrix3d& sum, std::vector<Eigen::Matrix3d>& rotations) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d R = NearestRotation(sum);
  rotations.push_back(R);
  if (svd.singularValues()[1] > kOneAxisRatio * svd.singularValues()[0]) return;
  for (int turn = 1; turn < kTurns; ++turn)
    rotations.push_back(Eigen::AngleAxisd(2 * M_PI * turn / kTurns, svd.matrixU().col(0)) * R);
}

// min |(R_A - 1) t - (R_X t_B - t_A)|, shortest along what the motions hardly tell.
Eigen::Vector3d TranslationOf(const std::vector<MotionPair>& motions, const Eigen::Matrix3d& R_X) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const MotionPair& motion : motions) {
    const Eigen::Matrix3d M = motion.A.R() - Eigen::Matrix3d::Identity();
    normal += M.transpose() * M;
    right += M.transpose() * (R_X * motion.B.p_m - motion.A.p_m);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal);
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (!(solver.eigenvalues()[i] > kWeakShare * solver.eigenvalues()[2])) continue;
    t += solver.eigenvectors().col(i) * (solver.eigenvectors().col(i).dot(right) / solver.eigenvalues()[i]);
  }
  return t;
}

}  // namespace

std::vector<Se3> StartsOf(const std::vector<MotionPair>& motions) {
  Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero(), translations = Eigen::Matrix3d::Zero();
  for (const MotionPair& motion : motions) {
    const Eigen::Vector3d a = RotationOf(motion.A), b = RotationOf(motion.B);
    if (a.norm() < kNearlyHalfTurn_rad && b.norm() < kNearlyHalfTurn_rad) rotations += a * b.transpose();
    translations += motion.A.p_m * motion.B.p_m.transpose();
  }
  std::vector<Eigen::Matrix3d> candidates;
  if (rotations.norm() > kRotations_rad2 * static_cast<double>(motions.size()))
    AddRotations(rotations, candidates);
  else
    AddRotations(translations, candidates);
  std::vector<Se3> starts;
  if (motions.empty()) return starts;
  for (const Eigen::Matrix3d& R : candidates)
    starts.push_back(Se3{TranslationOf(motions, R), Eigen::Quaterniond(R)}.Normalized());
  return starts;
}

ClosedForm ClosedFormOf(const std::vector<Se3>& a, const std::vector<Se3>& b) {
  Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero(), means = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      const Eigen::Vector3d u = RotationOf(a[i].Inverse() * a[j]), v = RotationOf(b[i].Inverse() * b[j]);
      if (u.norm() < kNearlyHalfTurn_rad && v.norm() < kNearlyHalfTurn_rad) rotations += u * v.transpose();
    }
  const Eigen::Matrix3d R_X = NearestRotation(rotations);
  for (std::size_t i = 0; i < a.size(); ++i) means += a[i].R() * R_X * b[i].R().transpose();
  const Eigen::Matrix3d R_Z = NearestRotation(means);
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < a.size(); ++i) {
    Eigen::Matrix<double, 3, 6> M;
    M << a[i].R(), -Eigen::Matrix3d::Identity();
    normal += M.transpose() * M;
    right += M.transpose() * (R_Z * b[i].p_m - a[i].p_m);
  }
  const Eigen::Matrix<double, 6, 1> t = normal.completeOrthogonalDecomposition().solve(right);
  return {Se3{t.head<3>(), Eigen::Quaterniond(R_X)}.Normalized(),
          Se3{t.tail<3>(), Eigen::Quaterniond(R_Z)}.Normalized()};
}

}  // namespace rigcal::calib
