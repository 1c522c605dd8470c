#include "tests/unit/calib/virtual_lidar.h"

#include <opencv2/calib3d.hpp>
#include <random>

namespace rigcal::calib {
namespace {

using Random = std::mt19937;

BoardView ViewOf(const VirtualLidarRig& rig, const Se3& T_cam_board, Random& random) {
  std::vector<cv::Point3d> points;
  for (const Eigen::Vector3d& p : TargetPoints(rig.board)) {
    const Eigen::Vector3d p_cam = T_cam_board * p;
    points.emplace_back(p_cam.x(), p_cam.y(), p_cam.z());
  }
  const CameraIntrinsics& k = rig.intrinsics;
  const cv::Matx33d K(k.fx_px, 0, k.cx_px, 0, k.fy_px, k.cy_px, 0, 0, 1);
  const cv::Vec4d D(k.distortion[0], k.distortion[1], k.distortion[2], k.distortion[3]);
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(points, pixels, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K, D);
  BoardView view{true, "", rig.board.id, 1280, 720, {}};
  std::normal_distribution<double> noise(0, 1);
  for (const cv::Point2d& pixel : pixels) {
    view.corner_idx.push_back(static_cast<int>(view.corners_px.size()));
    const double du = noise(random), dv = noise(random);
    view.corners_px.emplace_back(pixel.x + rig.corner_sigma_px * du, pixel.y + rig.corner_sigma_px * dv);
  }
  return view;
}

// What the beams see of a plate at T_lidar_plate (origin in its middle, z away from the sensor).
PlanePatch PatchOf(const VirtualLidarRig& rig, const Se3& T_lidar_plate, const Eigen::Vector2d& size_m,
                   Random& random) {
  std::normal_distribution<double> noise(0, 1);
  PlanePatch patch;
  patch.normal = -T_lidar_plate.R().col(2);
  patch.centre_m = T_lidar_plate.p_m;
  patch.extent_m = {size_m.maxCoeff(), size_m.minCoeff()};
  patch.score = 0.9;
  for (double v = -0.45; v <= 0.451; v += 0.1)
    for (double u = -0.45; u <= 0.451; u += 0.03) {
      const Eigen::Vector3d p = T_lidar_plate * Eigen::Vector3d(u * size_m.x(), v * size_m.y(), 0);
      const double shift_m = rig.range_sigma_m * noise(random) - rig.range_bias_m;
      patch.points_m.emplace_back((p + shift_m * p.normalized()).cast<float>());
    }
  return patch;
}

CloudView CloudOf(const VirtualLidarRig& rig, const Se3& T_cam_board, Random& random) {
  const Eigen::Vector2d size_m = *rig.board.plate_m;
  Se3 T_board_plate;
  T_board_plate.p_m = CentreOf(rig.board);
  CloudView cloud;
  cloud.found = true;
  cloud.target = rig.board.id;
  cloud.points = 30000;
  const Se3 T_lidar_plate = rig.T_cam_lidar.Inverse() * T_cam_board * T_board_plate;
  cloud.candidates.push_back(PatchOf(rig, T_lidar_plate, size_m, random));
  if (!rig.decoys) return cloud;
  std::uniform_real_distribution<double> place(-1, 1);
  for (int i = 0; i < 3; ++i) {  // furniture: anywhere, any tilt
    const double x = 4 * place(random), y = 4 * place(random), z = place(random), rx = place(random),
                 ry = place(random);
    const Se3 T_lidar_other = T_lidar_plate * Se3::Exp((Vector6d() << x, y, z, rx, ry, 0).finished());
    cloud.candidates.push_back(PatchOf(rig, T_lidar_other, size_m, random));
  }
  std::swap(cloud.candidates.front(), cloud.candidates.back());
  return cloud;
}

}  // namespace

VirtualLidarRig::VirtualLidarRig() {
  // The lidar's x looks along the camera's z, its z up.
  T_cam_lidar.q =
      Eigen::Quaterniond((Eigen::Matrix3d() << 0, -1, 0, 0, 0, -1, 1, 0, 0).finished() *
                         Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix());
  T_cam_lidar.p_m = {0.06, -0.18, -0.09};
  board = {TargetId("board"), 7, 5, 0.1, 0.0, ""};
  board.plate_m = {0.9, 0.7};
}

std::vector<Se3> BoardsBefore(int count, double tilt_rad) {
  std::vector<Se3> boards;
  for (int i = 0; i < count; ++i) {
    const double turn = 2.4 * i;  // radians: never the same direction twice
    const Eigen::Vector3d axis(std::cos(turn), std::sin(turn), 0.3 * std::sin(3.7 * i));
    Se3 T_cam_board;
    T_cam_board.q =
        Eigen::Quaterniond(Eigen::AngleAxisd(tilt_rad * (0.4 + 0.6 * ((i * 7) % 10) / 9.0), axis.normalized()));
    const double z = 2 + 3 * ((i * 3) % 8) / 7.0;
    T_cam_board.p_m = {0.35 * z * std::sin(1.7 * i) - 0.3, 0.2 * z * std::cos(2.9 * i) - 0.2, z};
    boards.push_back(T_cam_board);
  }
  return boards;
}

LidarCameraProblem Recorded(const VirtualLidarRig& rig, const std::vector<Se3>& T_cam_board, unsigned seed) {
  Random random(seed);
  LidarCameraProblem problem;
  problem.camera.id = SensorId("front");
  problem.camera.camera_model = rig.intrinsics.model;
  problem.camera.intrinsics = rig.intrinsics;
  problem.lidar.id = SensorId("top");
  problem.lidar.kind = SensorKind::kLidar;
  problem.board = rig.board;
  for (std::size_t i = 0; i < T_cam_board.size(); ++i) {
    const std::string name = std::to_string(1000 + i).substr(1);
    const BoardView view = ViewOf(rig, T_cam_board[i], random);
    problem.captures.push_back({CaptureId(name), view, CloudOf(rig, T_cam_board[i], random)});
  }
  return problem;
}

}  // namespace rigcal::calib
