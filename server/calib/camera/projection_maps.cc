#include "server/calib/camera/lens_change.h"

#include <Eigen/QR>
#include <algorithm>

#include "server/calib/camera/projection.h"
#include "server/math/se3.h"
#include "server/model/coverage.h"

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

}  // namespace rigcal::calib
