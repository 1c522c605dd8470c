#include "tests/unit/calib/virtual_pair.h"

#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>
#include <random>

#include "client/sim/rig/lens.h"

namespace rigcal::calib {
namespace {

std::vector<cv::Point2d> SpherePixels(const CameraIntrinsics& camera, const Target& board, const Se3& T_cam_board) {
  std::vector<Eigen::Vector3d> points_cam;
  for (const Eigen::Vector3d& p_board : TargetPoints(board)) points_cam.push_back(T_cam_board * p_board);
  std::vector<cv::Point2d> pixels;
  for (const Eigen::Vector2d& uv_px : sim::PixelsOf(camera, points_cam)) pixels.emplace_back(uv_px.x(), uv_px.y());
  return pixels;
}

std::vector<cv::Point2d> Projected(const CameraIntrinsics& camera, const Target& board, const Se3& T_cam_board) {
  if (IsSphere(camera.model)) return SpherePixels(camera, board, T_cam_board);
  std::vector<cv::Point3d> points;
  for (int row = 0; row < board.rows; ++row)
    for (int col = 0; col < board.cols; ++col) {
      const Eigen::Vector3d p = T_cam_board.R() * Eigen::Vector3d(col * board.square_m, row * board.square_m, 0);
      points.emplace_back(p.x() + T_cam_board.p_m.x(), p.y() + T_cam_board.p_m.y(), p.z() + T_cam_board.p_m.z());
    }
  const cv::Matx33d K(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const cv::Vec3d zero(0, 0, 0);
  std::vector<cv::Point2d> pixels;
  if (camera.model == CameraModel::kFisheyeKb4)
    cv::fisheye::projectPoints(points, pixels, zero, zero, K, camera.distortion);
  else
    cv::projectPoints(points, zero, zero, K, camera.distortion, pixels);
  return pixels;
}

BoardView ViewOf(const VirtualPair& pair, const CameraIntrinsics& camera, const Se3& T_cam_board, double sigma_px,
                 std::mt19937& random) {
  std::normal_distribution<double> noise(0, 1);
  BoardView view{true, "", pair.board.id, pair.width_px, pair.height_px, {}};
  for (const cv::Point2d& pixel : Projected(camera, pair.board, T_cam_board)) {
    const double du = sigma_px * noise(random), dv = sigma_px * noise(random);
    view.corner_idx.push_back(static_cast<int>(view.corners_px.size()));
    view.corners_px.emplace_back(pixel.x + du, pixel.y + dv);
  }
  return view;
}

}  // namespace

VirtualPair::VirtualPair() {
  T_a_b.p_m = {0.11, -0.004, 0.007};
  T_a_b.q = Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.2, -1, 0.3).normalized());
}

VirtualPair PairOf(CameraModel model) {
  VirtualPair pair;
  if (model == CameraModel::kPinholeRational) {
    pair.a = {330, 328, 322, 238, {0.6, 0.1, 0.001, -0.0007, 0.01, 0.9, 0.25, 0.05}, model};
    pair.b = {325, 327, 315, 244, {0.5, 0.1, -0.0005, 0.0009, 0.01, 0.8, 0.2, 0.04}, model};
  } else if (model == CameraModel::kFisheyeKb4) {
    pair.a = {300, 298, 322, 238, {-0.02, 0.01, -0.006, 0.001}, model};
    pair.b = {290, 292, 315, 244, {-0.01, 0.005, -0.004, 0.0005}, model};
  } else if (model == CameraModel::kEucm) {
    pair.a = {300, 298, 322, 238, {0.61, 1.07}, model};
    pair.b = {290, 292, 315, 244, {0.57, 1.15}, model};
  } else if (model == CameraModel::kDoubleSphere) {
    pair.a = {235, 233, 322, 238, {-0.22, 0.58}, model};
    pair.b = {232, 234, 315, 244, {-0.19, 0.6}, model};
  }
  return pair;
}

std::vector<Se3> SpreadBoards(int count) {
  std::vector<Se3> boards;
  for (int k = 0; k < count; ++k) {
    // Rings at up to 40 degrees from the axis; every board leans its own way.
    const double around = 2.4 * k, off = 0.7 * std::sqrt((k % 5) / 4.0), range_m = 0.32 + 0.05 * std::sin(1.9 * k);
    const Eigen::Vector3d centre(0.05 + range_m * std::sin(off) * std::cos(around),
                                 0.8 * range_m * std::sin(off) * std::sin(around), range_m * std::cos(off));
    const double lean = 0.2 + 0.35 * ((k * 7) % 11) / 10.0;
    boards.push_back(
        BoardAt(VirtualPair(), centre, {lean * std::cos(1.3 * k), lean * std::sin(1.3 * k), 0.15 * std::sin(1.7 * k)}));
  }
  return boards;
}

BoardView SeenFrom(const BoardView& view, const Target& board, int turn) {
  BoardView turned = view;
  for (std::size_t i = 0; i < view.corners_px.size(); ++i)
    turned.corners_px[static_cast<std::size_t>(TurnedIndex(board, static_cast<int>(i), turn))] = view.corners_px[i];
  return turned;
}

BoardView Part(const BoardView& view, const Target& board, int col_first, int col_end) {
  BoardView part = view;
  part.corners_px.clear();
  part.corner_idx.clear();
  for (std::size_t i = 0; i < view.corners_px.size(); ++i) {
    const int col = view.corner_idx[i] % board.cols;
    if (col < col_first || col >= col_end) continue;
    part.corners_px.push_back(view.corners_px[i]);
    part.corner_idx.push_back(view.corner_idx[i]);
  }
  return part;
}

Se3 BoardAt(const VirtualPair& pair, const Eigen::Vector3d& centre_m, const Eigen::Vector3d& rotation_rad) {
  Se3 T_a_board;
  if (rotation_rad.norm() > 0) T_a_board.q = Eigen::AngleAxisd(rotation_rad.norm(), rotation_rad.normalized());
  const Eigen::Vector3d middle =
      0.5 * pair.board.square_m * Eigen::Vector3d(pair.board.cols - 1, pair.board.rows - 1, 0);
  T_a_board.p_m = centre_m - T_a_board.R() * middle;
  return T_a_board;
}

std::vector<Se3> TiltedBoards(int count) {
  std::vector<Se3> boards;
  for (int k = 0; k < count; ++k) {
    const double turn = 2.4 * k, tilt = 0.25 + 0.28 * ((k * 7) % 11) / 10.0;
    const Eigen::Vector3d rotation(tilt * std::cos(turn), tilt * std::sin(turn), 0.15 * std::sin(1.7 * k));
    const Eigen::Vector3d centre(0.05 + 0.07 * std::sin(2.1 * k), 0.05 * std::cos(1.3 * k),
                                 0.47 + 0.06 * std::sin(0.9 * k));
    boards.push_back(BoardAt(VirtualPair(), centre, rotation));
  }
  return boards;
}

StereoProblem Photographed(const VirtualPair& pair, const std::vector<Se3>& T_a_board, double sigma_px, unsigned seed) {
  std::mt19937 random(seed);
  StereoProblem problem;
  problem.camera_a.id = SensorId("front_left");
  problem.camera_b.id = SensorId("front_right");
  problem.board = pair.board;
  problem.camera_a.camera_model = pair.a.model;
  problem.camera_b.camera_model = pair.b.model;
  for (std::size_t k = 0; k < T_a_board.size(); ++k) {
    char name[32];
    std::snprintf(name, sizeof name, "%03zu", k);
    const BoardView a = ViewOf(pair, pair.a, T_a_board[k], sigma_px, random);
    const BoardView b = ViewOf(pair, pair.b, pair.T_a_b.Inverse() * T_a_board[k], sigma_px, random);
    problem.captures.push_back({CaptureId(name), a, b});
  }
  return problem;
}

BoardView NotFoundView() { return {false, "no 9 x 6 board in the picture", TargetId("board"), 640, 480, {}}; }

}  // namespace rigcal::calib
