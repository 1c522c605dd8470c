#include "client/moments/pose_track.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "server/calib/camera/intrinsics.h"
#include "server/calib/camera/projection.h"
#include "server/calib/camera/seen_corners.h"

namespace rigcal::moments {
namespace {

constexpr std::size_t kLensSightsMax = 30;
constexpr double kAheadMin = 0.2;  // of the z of a unit ray: beyond, a plane of rays no longer serves

BoardView ViewOf(const Sight& sight, const Target& target) {
  BoardView view;
  view.found = true;
  view.target = target.id;
  view.image_width_px = sight.width_px, view.image_height_px = sight.height_px;
  view.corner_idx = sight.corner_idx;
  for (const Eigen::Vector2f& corner : sight.corners_px) view.corners_px.push_back(corner.cast<double>());
  return view;
}

std::vector<const Sight*> SpreadSights(const std::vector<Sight>& sights, int target_idx) {
  std::vector<const Sight*> found;
  for (const Sight& sight : sights)
    if (sight.target_idx == target_idx) found.push_back(&sight);
  std::vector<const Sight*> spread;
  const std::size_t stride = std::max<std::size_t>(1, found.size() / kLensSightsMax);
  for (std::size_t i = stride / 2; i < found.size(); i += stride) spread.push_back(found[i]);
  return spread;
}

std::optional<CameraIntrinsics> LensOf(const Sensor& camera, const Target& board, int target_idx,
                                       const std::vector<Sight>& sights) {
  if (camera.intrinsics) return camera.intrinsics;
  calib::CameraProblem problem{camera, board, {}};
  int number = 0;
  for (const Sight* sight : SpreadSights(sights, target_idx))
    problem.views.emplace_back(CaptureId("s" + std::to_string(1000 + number++)), ViewOf(*sight, board));
  const auto estimate = calib::EstimateCamera(problem);
  return estimate ? std::optional(estimate->intrinsics) : std::nullopt;
}

Se3 PoseOf(const cv::Mat& turn, const cv::Mat& shift) {
  Eigen::Vector3d rotation_rad, p_m;
  cv::cv2eigen(turn, rotation_rad);
  cv::cv2eigen(shift, p_m);
  const double angle_rad = rotation_rad.norm();
  Se3 T;
  T.p_m = p_m;
  if (angle_rad > 0) T.q = Eigen::AngleAxisd(angle_rad, rotation_rad / angle_rad);
  return T.Normalized();
}

class Tracker {
 public:
  Tracker(const CameraIntrinsics& lens, const Target& target)
      : model_(lens.model),
        lens_(calib::VectorOf(lens)),
        points_m_(TargetPoints(target)),
        corners_min_(calib::CornersMin(target)) {}

  // Nothing where too few corners are before the camera.
  std::optional<Se3> PoseOfSight(const Sight& sight) {
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> rays;
    for (std::size_t i = 0; i < sight.corner_idx.size(); ++i) {
      const auto ray = calib::Unproject(model_, lens_, sight.corners_px[i].cast<double>());
      if (!ray || ray->z() < kAheadMin) continue;
      const Eigen::Vector3d& point = points_m_[static_cast<std::size_t>(sight.corner_idx[i])];
      points.emplace_back(point.x(), point.y(), point.z());
      rays.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
    }
    if (rays.size() < corners_min_) return std::nullopt;
    return Nearest(Allowed(points, rays));
  }

 private:
  [[nodiscard]] static std::vector<Se3> Allowed(const std::vector<cv::Point3d>& points,
                                                const std::vector<cv::Point2d>& rays) {
    std::vector<cv::Mat> turns, shifts;
    cv::solvePnPGeneric(points, rays, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns, shifts, false,
                        cv::SOLVEPNP_IPPE);
    std::vector<Se3> poses;
    for (std::size_t i = 0; i < turns.size(); ++i) {
      cv::solvePnPRefineLM(points, rays, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turns[i], shifts[i]);
      if (shifts[i].at<double>(2) > 0) poses.push_back(PoseOf(turns[i], shifts[i]));
    }
    return poses;
  }

  std::optional<Se3> Nearest(const std::vector<Se3>& poses) {
    if (poses.empty()) return std::nullopt;
    const auto turn = [&](const Se3& T) { return last_ ? last_->q.angularDistance(T.q) : 0.0; };
    last_ =
        *std::min_element(poses.begin(), poses.end(), [&](const Se3& a, const Se3& b) { return turn(a) < turn(b); });
    return last_;
  }

  CameraModel model_;
  calib::IntrinsicsVector lens_;
  std::vector<Eigen::Vector3d> points_m_;
  std::size_t corners_min_;
  std::optional<Se3> last_;
};

}  // namespace

std::vector<TimedPose> PosesOf(const Sensor& camera, const Target& target, int target_idx,
                               const std::vector<Sight>& sights, std::int64_t begin_ns) {
  const auto lens = LensOf(camera, target, target_idx, sights);
  if (!lens) return {};
  Tracker tracker(*lens, target);
  std::vector<TimedPose> track;
  for (const Sight& sight : sights) {
    if (sight.target_idx != target_idx) continue;
    const auto pose = tracker.PoseOfSight(sight);
    if (pose) track.push_back({static_cast<double>(sight.stamp_ns - begin_ns) * 1e-9, *pose});
  }
  std::sort(track.begin(), track.end(), [](const TimedPose& a, const TimedPose& b) { return a.t_s < b.t_s; });
  return track;
}

}  // namespace rigcal::moments
