#include "server/calib/camera_start.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

namespace rigcal::calib {
namespace {

// Enough for a start, and the cost of OpenCV's solver grows with the cube of the number of views.
constexpr std::size_t kViewsMax = 30;
// Lenses from 10 to 150 degrees of view; a start outside comes from noise.
constexpr double kFocalMinRatio = 0.15, kFocalMaxRatio = 6.0;

std::vector<cv::Point3f> ObjectPoints(const std::vector<Eigen::Vector3d>& corners_board) {
  std::vector<cv::Point3f> points;
  for (const Eigen::Vector3d& p : corners_board)
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  return points;
}

std::vector<cv::Point2f> ImagePoints(const std::vector<Eigen::Vector2d>& corners_px) {
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& uv : corners_px)
    points.emplace_back(static_cast<float>(uv.x()), static_cast<float>(uv.y()));
  return points;
}

struct CvViews {
  std::vector<std::vector<cv::Point3f>> object;
  std::vector<std::vector<cv::Point2f>> image;
};

CvViews SpreadViews(const CameraViews& views) {
  CvViews result;
  const std::size_t total = views.corners_px.size(), count = std::min(total, kViewsMax);
  for (std::size_t i = 0; i < count; ++i) {
    result.object.push_back(ObjectPoints(views.corners_board));
    result.image.push_back(ImagePoints(views.corners_px[i * total / count]));
  }
  return result;
}

bool Plausible(double focal_px, const CameraViews& views) {
  const double side_px = std::max(views.width_px, views.height_px);
  return std::isfinite(focal_px) && focal_px > kFocalMinRatio * side_px && focal_px < kFocalMaxRatio * side_px;
}

cv::Mat CameraMatrix(const IntrinsicsVector& intrinsics) {
  cv::Mat matrix = cv::Mat::eye(3, 3, CV_64F);
  matrix.at<double>(0, 0) = intrinsics[0];
  matrix.at<double>(1, 1) = intrinsics[1];
  matrix.at<double>(0, 2) = intrinsics[2];
  matrix.at<double>(1, 2) = intrinsics[3];
  return matrix;
}

IntrinsicsVector FromCameraMatrix(const cv::Mat& matrix, const cv::Mat& distortion) {
  IntrinsicsVector intrinsics = IntrinsicsVector::Zero();
  intrinsics.head<4>() << matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2),
      matrix.at<double>(1, 2);
  for (int i = 0; i < std::min(5, static_cast<int>(distortion.total())); ++i)
    intrinsics[4 + i] = distortion.at<double>(i);
  return intrinsics;
}

Se3 PoseFrom(const cv::Mat& rvec, const cv::Mat& tvec) {
  const Eigen::Vector3d phi(rvec.at<double>(0), rvec.at<double>(1), rvec.at<double>(2));
  Se3 T_cam_board;
  T_cam_board.p_m = {tvec.at<double>(0), tvec.at<double>(1), tvec.at<double>(2)};
  if (phi.norm() > 0) T_cam_board.q = Eigen::AngleAxisd(phi.norm(), phi.normalized());
  return T_cam_board.Normalized();
}

bool Usable(const Se3& T_cam_board) {
  return T_cam_board.p_m.allFinite() && T_cam_board.q.coeffs().allFinite() && T_cam_board.p_m.z() > 0;
}

}  // namespace

IntrinsicsVector RoughIntrinsics(const CameraViews& views) {
  const double side_px = std::max(views.width_px, views.height_px);
  IntrinsicsVector rough = IntrinsicsVector::Zero();
  rough.head<4>() << side_px, side_px, 0.5 * (views.width_px - 1), 0.5 * (views.height_px - 1);
  try {
    const CvViews cv_views = SpreadViews(views);
    const cv::Mat matrix =
        cv::initCameraMatrix2D(cv_views.object, cv_views.image, {views.width_px, views.height_px}, 1.0);
    const double focal_px = matrix.at<double>(0, 0);
    if (Plausible(focal_px, views)) rough.head<2>().setConstant(focal_px);
  } catch (const cv::Exception&) {
    // The fallback stands.
  }
  return rough;
}

Result<IntrinsicsVector> ZhangIntrinsics(const CameraViews& views) {
  const auto failed = [] {
    return Fail(ErrorCode::kInvalidInput, "its intrinsics cannot be found from these views",
                "Take more captures with the board tilted in different directions.");
  };
  try {
    const CvViews cv_views = SpreadViews(views);
    cv::Mat matrix = CameraMatrix(RoughIntrinsics(views)), distortion = cv::Mat::zeros(1, 5, CV_64F);
    std::vector<cv::Mat> rvecs, tvecs;
    const int flags = cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_ZERO_TANGENT_DIST | cv::CALIB_FIX_K3;
    cv::calibrateCamera(cv_views.object, cv_views.image, {views.width_px, views.height_px}, matrix, distortion, rvecs,
                        tvecs, flags);
    const IntrinsicsVector intrinsics = FromCameraMatrix(matrix, distortion);
    if (!intrinsics.allFinite() || !Plausible(intrinsics[0], views) || !Plausible(intrinsics[1], views))
      return failed();
    return intrinsics;
  } catch (const cv::Exception&) {
    return failed();
  }
}

std::vector<Se3> PlanarPoses(const IntrinsicsVector& intrinsics, const std::vector<Eigen::Vector3d>& corners_board,
                             const std::vector<Eigen::Vector2d>& corners_px) {
  std::vector<Se3> poses;
  try {
    cv::Mat distortion(1, 5, CV_64F);
    for (int i = 0; i < 5; ++i) distortion.at<double>(i) = intrinsics[4 + i];
    std::vector<cv::Mat> rvecs, tvecs;
    cv::solvePnPGeneric(ObjectPoints(corners_board), ImagePoints(corners_px), CameraMatrix(intrinsics), distortion,
                        rvecs, tvecs, false, cv::SOLVEPNP_IPPE);
    for (std::size_t i = 0; i < rvecs.size(); ++i)
      if (const Se3 T_cam_board = PoseFrom(rvecs[i], tvecs[i]); Usable(T_cam_board)) poses.push_back(T_cam_board);
  } catch (const cv::Exception&) {
    poses.clear();
  }
  return poses;
}

}  // namespace rigcal::calib
