#include "server/calib/planes/planar_pose.h"

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <optional>

namespace rigcal::calib {
namespace {

constexpr std::size_t kPointsMin = 4;
const double kSmallestCosine = std::cos(80 * M_PI / 180);

struct Rays {
  std::vector<Eigen::Vector3d> p_board, rays_cam;
};

Rays RaysOf(CameraModel model, const IntrinsicsVector& intrinsics, const std::vector<Eigen::Vector3d>& corners_board,
            const SeenCorners& seen) {
  Rays rays;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const auto ray = Unproject(model, intrinsics, seen.uv_px[i]);
    if (!ray) continue;
    rays.p_board.push_back(corners_board[static_cast<std::size_t>(seen.idx[i])]);
    rays.rays_cam.push_back(*ray);
  }
  return rays;
}

// The view of a pinhole camera that looks along the middle of the rays.
struct CentredView {
  Eigen::Quaterniond q_cam_centred;
  std::vector<cv::Point3d> p_board;
  std::vector<cv::Point2d> xy;
};

std::optional<CentredView> Centred(const Rays& rays) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& ray : rays.rays_cam) middle += ray;
  if (!(middle.norm() > 1e-3)) return std::nullopt;
  CentredView view;
  view.q_cam_centred = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), middle);
  for (std::size_t i = 0; i < rays.rays_cam.size(); ++i) {
    const Eigen::Vector3d ray = view.q_cam_centred.conjugate() * rays.rays_cam[i];
    if (!(ray.z() > kSmallestCosine)) continue;
    view.p_board.emplace_back(rays.p_board[i].x(), rays.p_board[i].y(), rays.p_board[i].z());
    view.xy.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  if (view.xy.size() < kPointsMin) return std::nullopt;
  return view;
}

Se3 PoseFrom(const cv::Mat& rvec, const cv::Mat& tvec) {
  const Eigen::Vector3d phi(rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2));
  Se3 T;
  T.p_m = {tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2)};
  if (phi.norm() > 0) T.q = Eigen::AngleAxisd(phi.norm(), phi.normalized());
  return T.Normalized();
}

bool Usable(const Se3& T_centred_board, const CentredView& view) {
  if (!T_centred_board.p_m.allFinite() || !T_centred_board.q.coeffs().allFinite()) return false;
  for (const cv::Point3d& p : view.p_board)
    if (!((T_centred_board * Eigen::Vector3d(p.x, p.y, p.z)).z() > 0)) return false;
  return true;
}

constexpr double kSameMinimum_rad = 0.0175;

double RotationBetween_rad(const Se3& T, const Se3& S) { return (T.Inverse() * S).Log().tail<3>().norm(); }

double ErrorAt(const JointProblem& problem, JointState state, std::size_t capture_idx, const Se3& T_a_board) {
  state.T_a_board[capture_idx] = T_a_board;
  const CaptureError error = ErrorOf(problem, state, capture_idx);
  return error.a_px2 + error.b_px2;
}

}  // namespace

std::vector<Se3> PlanarPoses(CameraModel model, const IntrinsicsVector& intrinsics,
                             const std::vector<Eigen::Vector3d>& corners_board, const SeenCorners& seen) {
  const auto view = Centred(RaysOf(model, intrinsics, corners_board, seen));
  if (!view) return {};
  Se3 T_cam_centred;
  T_cam_centred.q = view->q_cam_centred;
  std::vector<Se3> poses;
  try {
    std::vector<cv::Mat> rvecs, tvecs;
    cv::solvePnPGeneric(view->p_board, view->xy, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), rvecs, tvecs, false,
                        cv::SOLVEPNP_IPPE);
    for (std::size_t i = 0; i < rvecs.size(); ++i)
      if (const Se3 T_centred_board = PoseFrom(rvecs[i], tvecs[i]); Usable(T_centred_board, *view))
        poses.push_back((T_cam_centred * T_centred_board).Normalized());
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) throw;
    poses.clear();
  }
  return poses;
}

std::vector<Se3> AllowedPoses(const JointProblem& problem, const JointState& state, std::size_t capture_idx) {
  const JointCapture& capture = problem.captures[capture_idx];
  std::vector<Se3> allowed;
  if (!capture.a.empty()) allowed = PlanarPoses(problem.a.model, state.intrinsics_a, problem.corners_board, capture.a);
  if (capture.b.empty()) return allowed;
  for (const Se3& T_b_board : PlanarPoses(problem.b.model, state.intrinsics_b, problem.corners_board, capture.b))
    allowed.push_back(state.T_a_b * T_b_board);
  return allowed;
}

PoseChoice ChoosePose(const JointProblem& problem, const JointState& state, std::size_t capture_idx,
                      const std::vector<Se3>& candidates) {
  struct Minimum {
    Se3 T_a_board;
    double ssr_px2;
  };
  std::vector<Minimum> minima;
  PoseChoice choice;
  for (const Se3& candidate : candidates) {
    if (!std::isfinite(ErrorAt(problem, state, capture_idx, candidate))) continue;
    const Se3 refined = SolveBoardPose(problem, state, capture_idx, candidate);
    minima.push_back({refined, ErrorAt(problem, state, capture_idx, refined)});
    if (minima.back().ssr_px2 < choice.ssr_px2) choice.T_a_board = refined, choice.ssr_px2 = minima.back().ssr_px2;
  }
  for (const Minimum& minimum : minima)
    if (minimum.ssr_px2 < choice.other_ssr_px2 &&
        RotationBetween_rad(minimum.T_a_board, choice.T_a_board) > kSameMinimum_rad)
      choice.T_a_board_other = minimum.T_a_board, choice.other_ssr_px2 = minimum.ssr_px2;
  return choice;
}

}  // namespace rigcal::calib
