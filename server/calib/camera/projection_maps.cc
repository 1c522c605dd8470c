#include "server/calib/camera/projection_maps.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "server/calib/camera/projection.h"
#include "server/math/se3.h"
#include "server/model/sensors/coverage.h"

namespace rigcal::calib {
namespace {

constexpr int kTurnStepsMax = 20;
constexpr double kTurned_rad = 1e-13;

// The middle of a field.
struct FarPoint {
  Eigen::Vector2d uv_px;               // before
  std::optional<Eigen::Vector3d> ray;  // before
  double weight = 0.0;
};

struct LensNow {
  CameraModel model;
  IntrinsicsVector intrinsics;
};

std::vector<FarPoint> PointsOf(const CameraFit& before, const Coverage& seen_before, const Coverage& seen_now) {
  const IntrinsicsVector intrinsics = VectorOf(before.intrinsics);
  std::vector<FarPoint> points;
  double weights = 0.0;
  for (int row = 0; row < seen_before.rows; ++row)
    for (int column = 0; column < seen_before.columns; ++column) {
      const double n0 = seen_before.At(column, row), n1 = seen_now.At(column, row);
      const Eigen::Vector2d uv_px(MiddleOf(column, before.width_px, seen_before.columns),
                                  MiddleOf(row, before.height_px, seen_before.rows));
      points.push_back(
          {uv_px, Unproject(before.intrinsics.model, intrinsics, uv_px), n0 > 0 && n1 > 0 ? n0 * n1 / (n0 + n1) : 0.0});
      weights += points.back().weight;
    }
  if (!(weights > 0))
    for (FarPoint& point : points) point.weight = 1.0;
  return points;
}

// One step of Gauss and Newton from R, as a rotation vector on its left; the shortest where the points leave some open.
Eigen::Vector3d TurnStep(const std::vector<FarPoint>& points, const LensNow& now, const Eigen::Matrix3d& R) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const FarPoint& point : points) {
    if (!point.ray || !(point.weight > 0)) continue;
    const Eigen::Vector3d turned = R * *point.ray;
    const Projection at = Project(now.model, now.intrinsics, turned);
    if (!at.in_front) continue;
    const Eigen::Matrix<double, 2, 3> by_turn = -at.d_point * Hat(turned);
    normal += point.weight * by_turn.transpose() * by_turn;
    gradient += point.weight * by_turn.transpose() * (at.uv_px - point.uv_px);
  }
  return -normal.completeOrthogonalDecomposition().solve(gradient);
}

Eigen::Matrix3d ImpliedTurn(const std::vector<FarPoint>& points, const LensNow& now) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (int i = 0; i < kTurnStepsMax; ++i) {
    const Eigen::Vector3d step = TurnStep(points, now, R);
    if (!step.allFinite()) return Eigen::Matrix3d::Identity();
    if (step.norm() < kTurned_rad) break;
    R = Eigen::AngleAxisd(step.norm(), step.normalized()).toRotationMatrix() * R;
  }
  return R;
}

std::optional<Eigen::Vector2d> ShiftOf(const FarPoint& point, const LensNow& now, const Eigen::Matrix3d& R) {
  if (!point.ray) return std::nullopt;
  const Projection at = Project(now.model, now.intrinsics, R * *point.ray, false);
  if (!at.in_front || !at.uv_px.allFinite()) return std::nullopt;
  return at.uv_px - point.uv_px;
}

}  // namespace

std::optional<LensChange> ChangeOfLens(const CameraFit& before, const CameraFit& now) {
  if (before.source == IntrinsicsSource::kNone || now.source == IntrinsicsSource::kNone) return std::nullopt;
  if (before.width_px != now.width_px || before.height_px != now.height_px || now.width_px <= 0 || now.height_px <= 0)
    return std::nullopt;
  const Coverage seen_before = CoverageOf(before), seen_now = CoverageOf(now);
  const std::vector<FarPoint> points = PointsOf(before, seen_before, seen_now);
  const LensNow lens{now.intrinsics.model, VectorOf(now.intrinsics)};
  const Eigen::Matrix3d R = ImpliedTurn(points, lens);
  LensChange change{now.camera, now.width_px, now.height_px, seen_now.columns, seen_now.rows, {}, {}, 0.0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    change.shift_px.push_back(ShiftOf(points[i], lens, R));
    change.seen.push_back(seen_before.corners[i] > 0 && seen_now.corners[i] > 0);
  }
  change.turn_rad = Eigen::AngleAxisd(R).angle();
  return change;
}

namespace {

using PointMotion = Eigen::Matrix<double, 3, Eigen::Dynamic>;  // of a point, by the intrinsics

// The square root of the larger eigenvalue.
std::optional<double> WorstDirection(const Eigen::Matrix2d& variance) {
  const double mean = 0.5 * variance.trace(), half = 0.5 * (variance(0, 0) - variance(1, 1));
  const double largest = mean + std::hypot(half, 0.5 * (variance(0, 1) + variance(1, 0)));
  if (!std::isfinite(largest)) return std::nullopt;
  return std::sqrt(std::max(largest, 0.0));
}

std::optional<double> SigmaOfPoint(const CameraFit& fit, const IntrinsicsVector& intrinsics,
                                   const Eigen::Vector3d& p_cam, const PointMotion& motion) {
  const Projection at = Project(fit.intrinsics.model, intrinsics, p_cam);
  if (!at.in_front) return std::nullopt;
  const Eigen::Matrix<double, 2, Eigen::Dynamic> P =
      at.d_intrinsics.leftCols(fit.covariance.cols()) + at.d_point * motion;
  return WorstDirection(P * fit.covariance * P.transpose());
}

PointSigma SigmaAt(const CameraFit& fit, const IntrinsicsVector& intrinsics, const Eigen::Vector2d& uv_px) {
  const auto ray = Unproject(fit.intrinsics.model, intrinsics, uv_px);
  if (!ray) return {};
  const PointMotion turn = -Hat(*ray) * fit.implied_motion.bottomRows<3>();
  const PointMotion shift = fit.implied_motion.topRows<3>();
  return {SigmaOfPoint(fit, intrinsics, *ray, turn),
          SigmaOfPoint(fit, intrinsics, kNearPoint_m * *ray, kNearPoint_m * turn + shift)};
}

}  // namespace

std::optional<ProjectionUncertainty> UncertaintyOfProjections(const CameraFit& fit) {
  if (fit.covariance.size() == 0 || fit.width_px <= 0 || fit.height_px <= 0) return std::nullopt;
  const IntrinsicsVector intrinsics = VectorOf(fit.intrinsics);
  const Coverage coverage = CoverageOf(fit);
  ProjectionUncertainty map{coverage.columns, coverage.rows, {}, {}};
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      map.fields.push_back(SigmaAt(
          fit, intrinsics, {MiddleOf(column, fit.width_px, map.columns), MiddleOf(row, fit.height_px, map.rows)}));
  map.middle = SigmaAt(fit, intrinsics, {MiddleOf(0, fit.width_px, 1), MiddleOf(0, fit.height_px, 1)});
  return map;
}

}  // namespace rigcal::calib
