#include "client/sim/rig/lens.h"

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "client/sim/rig/sphere_lens.h"

namespace rigcal::sim {
namespace {

cv::Matx33d MatrixOf(const CameraIntrinsics& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

bool IsFisheye(const CameraIntrinsics& camera) { return camera.model == CameraModel::kFisheyeKb4; }

std::vector<cv::Point3d> CvPoints(const std::vector<Eigen::Vector3d>& points) {
  std::vector<cv::Point3d> converted;
  for (const Eigen::Vector3d& p : points) converted.emplace_back(p.x(), p.y(), p.z());
  return converted;
}

std::vector<cv::Point2d> Projected(const CameraIntrinsics& camera, const std::vector<Eigen::Vector3d>& points,
                                   cv::Mat* jacobian) {
  std::vector<cv::Point2d> pixels;
  const cv::Vec3d none(0, 0, 0);
  const cv::_OutputArray wanted = jacobian != nullptr ? cv::_OutputArray(*jacobian) : cv::_OutputArray(cv::noArray());
  if (IsFisheye(camera))
    cv::fisheye::projectPoints(CvPoints(points), pixels, none, none, MatrixOf(camera), camera.distortion, 0.0, wanted);
  else
    cv::projectPoints(CvPoints(points), none, none, MatrixOf(camera), camera.distortion, pixels, wanted);
  return pixels;
}

// OpenCV orders its columns: pinhole rvec tvec f c distortion; fisheye f c distortion rvec tvec skew.
struct Columns {
  int translation, intrinsics;
};
Columns ColumnsOf(const CameraIntrinsics& camera) { return IsFisheye(camera) ? Columns{11, 0} : Columns{3, 6}; }

// theta (1 + k1 theta^2 + ...) = theta_d by Newton; fields of view up to 180 degrees.
double AngleOf(const std::vector<double>& k, double theta_d) {
  double theta = std::min(theta_d, M_PI / 2);
  for (int i = 0; i < 30; ++i) {
    const double s = theta * theta;
    const double value = theta * (1 + s * (k[0] + s * (k[1] + s * (k[2] + s * k[3]))));
    const double slope = 1 + s * (3 * k[0] + s * (5 * k[1] + s * (7 * k[2] + s * 9 * k[3])));
    theta -= (value - theta_d) / std::max(slope, 0.1);
  }
  return theta;
}

Eigen::Vector3d FisheyeRay(const CameraIntrinsics& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d image((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px);
  const double theta_d = image.norm();
  if (theta_d < 1e-12) return Eigen::Vector3d::UnitZ();
  const double theta = AngleOf(camera.distortion, theta_d);
  const Eigen::Vector2d sideways = std::sin(theta) / theta_d * image;
  return {sideways.x(), sideways.y(), std::cos(theta)};
}

std::vector<Eigen::Vector3d> PinholeRays(const CameraIntrinsics& camera, const std::vector<Eigen::Vector2d>& pixels) {
  std::vector<cv::Point2d> distorted, ideal;
  for (const Eigen::Vector2d& pixel : pixels) distorted.emplace_back(pixel.x(), pixel.y());
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-9);
  cv::undistortPoints(distorted, ideal, MatrixOf(camera), camera.distortion, cv::noArray(), cv::noArray(), until);
  std::vector<Eigen::Vector3d> rays;
  for (const cv::Point2d& p : ideal) rays.emplace_back(p.x, p.y, 1.0);
  return rays;
}

}  // namespace

std::vector<Eigen::Vector2d> PixelsOf(const CameraIntrinsics& intrinsics,
                                      const std::vector<Eigen::Vector3d>& points_cam) {
  std::vector<Eigen::Vector2d> pixels;
  if (points_cam.empty()) return pixels;
  if (IsSphere(intrinsics.model)) return SpherePixelsOf(intrinsics, points_cam);
  for (const cv::Point2d& p : Projected(intrinsics, points_cam, nullptr)) pixels.emplace_back(p.x, p.y);
  return pixels;
}

std::vector<LensPoint> PixelsWithDerivatives(const CameraIntrinsics& intrinsics,
                                             const std::vector<Eigen::Vector3d>& points_cam) {
  if (points_cam.empty()) return {};
  if (IsSphere(intrinsics.model)) return SpherePixelsWithDerivatives(intrinsics, points_cam);
  cv::Mat jacobian;
  const std::vector<cv::Point2d> pixels = Projected(intrinsics, points_cam, &jacobian);
  const Columns at = ColumnsOf(intrinsics);
  const auto count = static_cast<int>(4 + intrinsics.distortion.size());
  std::vector<LensPoint> points(pixels.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].uv_px = {pixels[i].x, pixels[i].y};
    points[i].d_intrinsics.resize(2, count);
    for (int row = 0; row < 2; ++row) {
      const double* values = jacobian.ptr<double>(2 * static_cast<int>(i) + row);
      for (int k = 0; k < 3; ++k) points[i].d_point(row, k) = values[at.translation + k];
      for (int k = 0; k < count; ++k) points[i].d_intrinsics(row, k) = values[at.intrinsics + k];
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> RaysOf(const CameraIntrinsics& intrinsics, const std::vector<Eigen::Vector2d>& pixels) {
  if (pixels.empty()) return {};
  if (IsPinhole(intrinsics.model)) return PinholeRays(intrinsics, pixels);
  if (IsSphere(intrinsics.model)) return SphereRaysOf(intrinsics, pixels);
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& pixel : pixels) rays.push_back(FisheyeRay(intrinsics, pixel));
  return rays;
}

CameraIntrinsics Scaled(const CameraIntrinsics& intrinsics, double scale) {
  CameraIntrinsics scaled = intrinsics;
  scaled.fx_px *= scale;
  scaled.fy_px *= scale;
  scaled.cx_px = (intrinsics.cx_px + 0.5) * scale - 0.5;
  scaled.cy_px = (intrinsics.cy_px + 0.5) * scale - 0.5;
  return scaled;
}

}  // namespace rigcal::sim
