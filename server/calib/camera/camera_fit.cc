#include "server/calib/camera/camera_fit.h"

#include <cmath>

#include "server/calib/camera/given_intrinsics.h"
#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"
#include "server/calib/camera/view_moments.h"
#include "server/calib/core/selection.h"
#include "server/calib/motion/camera_motion.h"

namespace rigcal::calib {
namespace {

constexpr std::size_t kViewsForJackknife = 5;

std::vector<double> SigmaOf(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd sigma = covariance.diagonal().cwiseSqrt();
  return {sigma.begin(), sigma.end()};
}

void SetSigma(const Sensor& camera, const GatheredViews& gathered, CameraFit& fit) {
  if (HoldsIntrinsics(camera)) {
    fit.source = IntrinsicsSource::kGiven;
    fit.sigma = camera.intrinsics_sigma.value_or(std::vector<double>());
    return;
  }
  const bool refines = RefinesIntrinsics(camera);
  fit.source = refines ? IntrinsicsSource::kRefined : IntrinsicsSource::kEstimated;
  fit.sigma_by_jackknife = !refines && gathered.views.size() >= kViewsForJackknife;
  fit.covariance = refines                  ? CovarianceWithGiven(camera, gathered)
                   : fit.sigma_by_jackknife ? CovarianceByJackknife(gathered)
                                            : CovarianceByModel(gathered);
  fit.sigma = SigmaOf(fit.covariance);
  fit.implied_motion = ImpliedMotion(gathered);
  if (fit.covariance.size() == 0 || fit.implied_motion.size() == 0) fit.covariance = fit.implied_motion = {};
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
  const IntrinsicsVector values = VectorOf(intrinsics);
  const std::vector<Eigen::Vector3d> points = TargetPoints(problem.board);
  GatheredViews gathered(model);
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
    gathered.Add(*moments, seen.size());
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
