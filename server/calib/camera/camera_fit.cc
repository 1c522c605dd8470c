#include "server/calib/camera/camera_fit.h"

#include <Eigen/LU>
#include <cmath>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/core/selection.h"
#include "server/calib/motion/camera_motion.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kViewsForJackknife = 5;

using IntrinsicsMatrix = Eigen::MatrixXd;

// What one view says of the intrinsics once its board's pose is eliminated.
struct ViewSays {
  IntrinsicsMatrix normal;
  Eigen::VectorXd gradient;
};

struct Gathered {
  std::vector<ViewSays> views;
  IntrinsicsMatrix normal;
  Eigen::VectorXd gradient;
  double ssr_px2 = 0.0;
  std::size_t numbers = 0;  // two per corner
};

ViewSays Reduced(const ViewMoments& moments, int count) {
  const Matrix6d inverse = Matrix6d(moments.normal.bottomRightCorner<6, 6>()).inverse();
  const Eigen::MatrixXd mixed = moments.normal.topRightCorner(count, 6);
  return {moments.normal.topLeftCorner(count, count) - mixed * inverse * mixed.transpose(),
          moments.gradient.head(count) - mixed * (inverse * moments.gradient.tail<6>())};
}

void Add(const ViewMoments& moments, std::size_t corners, int count, Gathered& gathered) {
  ViewSays says = Reduced(moments, count);
  gathered.normal += says.normal;
  gathered.gradient += says.gradient;
  gathered.ssr_px2 += moments.ssr_px2;
  gathered.numbers += 2 * corners;
  gathered.views.push_back(std::move(says));
}

// Scaled to a unit diagonal: focal lengths and distortion differ by many orders of magnitude. Not finite where a
// direction is open.
Eigen::VectorXd SolveScaled(const IntrinsicsMatrix& normal, const Eigen::VectorXd& right) {
  const Eigen::VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
  const IntrinsicsMatrix scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  return scale.cwiseProduct(scaled.fullPivLu().solve(scale.cwiseProduct(right)));
}

std::vector<double> Finite(const Eigen::VectorXd& variances) {
  if (!variances.allFinite() || !(variances.minCoeff() >= 0)) return {};
  const Eigen::VectorXd sigma = variances.cwiseSqrt();
  return {sigma.begin(), sigma.end()};
}

std::vector<double> ModelSigma(const Gathered& gathered) {
  const auto count = gathered.normal.rows();
  const double dof = static_cast<double>(gathered.numbers) - 6.0 * static_cast<double>(gathered.views.size()) -
                     static_cast<double>(count);
  if (!(dof > 0)) return {};
  Eigen::VectorXd variances(count);
  for (Eigen::Index i = 0; i < count; ++i)
    variances[i] = gathered.ssr_px2 / dof * SolveScaled(gathered.normal, Eigen::VectorXd::Unit(count, i))[i];
  return Finite(variances);
}

std::vector<double> JackknifeSigma(const Gathered& gathered) {
  const auto m = static_cast<double>(gathered.views.size());
  IntrinsicsMatrix moved(gathered.normal.rows(), static_cast<Eigen::Index>(gathered.views.size()));
  for (std::size_t i = 0; i < gathered.views.size(); ++i)
    moved.col(static_cast<Eigen::Index>(i)) =
        -SolveScaled(gathered.normal - gathered.views[i].normal, gathered.gradient - gathered.views[i].gradient);
  const Eigen::VectorXd mean = moved.rowwise().mean();
  return Finite((m - 1) / m * (moved.colwise() - mean).rowwise().squaredNorm());
}

// Of the views and of what was given together. What was given where the views leave no scatter.
std::vector<double> RefinedSigma(const Sensor& camera, const Gathered& gathered) {
  const std::vector<double>& given = *camera.intrinsics_sigma;
  const Eigen::Index count = gathered.normal.rows();
  const double dof = static_cast<double>(gathered.numbers) - 6.0 * static_cast<double>(gathered.views.size());
  if (!(dof > 0) || !(gathered.ssr_px2 > 0)) return given;
  IntrinsicsMatrix information = gathered.normal * (dof / gathered.ssr_px2);
  for (const int i : HeldOf(camera)) {
    information.row(i).setZero();
    information.col(i).setZero();
    information(i, i) = 1;
  }
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i)
    if (const double sigma = given[static_cast<std::size_t>(i)]; sigma > 0) information(i, i) += 1 / (sigma * sigma);
  for (Eigen::Index i = 0; i < count; ++i)
    if (given[static_cast<std::size_t>(i)] > 0)
      variances[i] = SolveScaled(information, Eigen::VectorXd::Unit(count, i))[i];
  return Finite(variances);
}

void SetSigma(const Sensor& camera, const Gathered& gathered, CameraFit& fit) {
  if (RefinesIntrinsics(camera)) {
    fit.source = IntrinsicsSource::kRefined;
    fit.sigma = RefinedSigma(camera, gathered);
    return;
  }
  if (camera.intrinsics) {
    fit.source = IntrinsicsSource::kGiven;
    fit.sigma = camera.intrinsics_sigma.value_or(std::vector<double>());
    return;
  }
  fit.source = IntrinsicsSource::kEstimated;
  fit.sigma_by_jackknife = gathered.views.size() >= kViewsForJackknife;
  fit.sigma = fit.sigma_by_jackknife ? JackknifeSigma(gathered) : ModelSigma(gathered);
}

// The board's normal that points to the camera, against the line of sight.
void SetStand(const Target& board, const Se3& T_cam_board, ViewFit& view) {
  const Eigen::Vector3d centre = T_cam_board * CentreOf(board);
  view.distance_m = centre.norm();
  if (!(view.distance_m > 0)) return;
  const Eigen::Vector3d z = centre / view.distance_m;
  const Eigen::Vector3d x = (Eigen::Vector3d::UnitX() - z.x() * z).normalized();
  const Eigen::Vector3d y = z.cross(x);
  Eigen::Vector3d away = T_cam_board.R().col(2);
  if (away.dot(z) < 0) away = -away;
  const Eigen::Vector2d across(away.dot(x), away.dot(y));
  if (across.norm() > 0) view.tilt_rad = across.normalized() * std::atan2(across.norm(), away.dot(z));
}

// Nothing where a corner lies where the camera cannot see.
std::optional<ViewFit> ViewOf(CameraModel model, const IntrinsicsVector& intrinsics, const Target& board,
                              const SeenCorners& seen, const Se3& T_cam_board) {
  const std::vector<Eigen::Vector3d> points = TargetPoints(board);
  ViewFit view;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const Projection at =
        Project(model, intrinsics, T_cam_board * points[static_cast<std::size_t>(seen.idx[i])], false);
    if (!at.in_front) return std::nullopt;
    view.uv_px.push_back(seen.uv_px[i]);
    view.residual_px.emplace_back(seen.uv_px[i] - at.uv_px);
  }
  SetStand(board, T_cam_board, view);
  return view;
}

void SetSize(const BoardView& view, CameraFit& fit) {
  fit.width_px = std::max(fit.width_px, view.image_width_px);
  fit.height_px = std::max(fit.height_px, view.image_height_px);
}

}  // namespace

CameraFit FitOf(const CameraProblem& problem, const CameraIntrinsics& intrinsics,
                const std::map<CaptureId, Se3>& T_cam_board, const std::map<CaptureId, int>& turns) {
  CameraFit fit;
  fit.camera = problem.camera.id;
  fit.intrinsics = intrinsics;
  const CameraModel model = intrinsics.model;
  const int count = IntrinsicsCount(model);
  const IntrinsicsVector values = VectorOf(intrinsics);
  const std::vector<Eigen::Vector3d> points = TargetPoints(problem.board);
  Gathered gathered{{}, IntrinsicsMatrix::Zero(count, count), Eigen::VectorXd::Zero(count), 0.0, 0};
  for (const auto& [capture, seen_view] : problem.views) {
    const auto pose = T_cam_board.find(capture);
    if (pose == T_cam_board.end() || !WhyUnusable(seen_view, problem.board).empty()) continue;
    const auto turn = turns.find(capture);
    const SeenCorners seen = SeenIn(seen_view, problem.board, turn == turns.end() ? 0 : turn->second);
    auto view = ViewOf(model, values, problem.board, seen, pose->second);
    const auto moments = MomentsAt(model, values, points, seen, pose->second);
    if (!view || !moments) continue;
    view->capture = capture;
    SetSize(seen_view, fit);
    Add(*moments, seen.size(), count, gathered);
    fit.views.push_back(std::move(*view));
  }
  SetSigma(problem.camera, gathered, fit);
  return fit;
}

CameraFit SeenBy(const CameraProblem& problem) {
  CameraFit fit;
  fit.camera = problem.camera.id;
  for (const auto& [capture, seen] : problem.views) {
    if (!WhyUnusable(seen, problem.board).empty()) continue;
    SetSize(seen, fit);
    ViewFit view;
    view.capture = capture;
    view.uv_px = seen.corners_px;
    fit.views.push_back(std::move(view));
  }
  return fit;
}

CameraFit FitOrSeen(const CameraProblem& problem, const CameraEstimate* camera) {
  return camera != nullptr ? FitOf(problem, camera->intrinsics, camera->T_cam_board) : SeenBy(problem);
}

}  // namespace rigcal::calib
