#include "server/calib/placement/candidates.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigcal::calib::placement {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kBorder_ratio = 0.05;  // of the picture's side: nobody holds a board to the pixel
constexpr double kObliqueCosine = 0.5;  // 60 degrees: beyond, corners are found badly
constexpr double kSquareMin_px = 10.0;  // of the shorter way across a square
constexpr std::array<double, 5> kAcross = {0.2, 0.35, 0.5, 0.65, 0.8};  // of the picture's width
constexpr std::array<double, 3> kDown = {0.25, 0.5, 0.75};
constexpr std::array<double, 5> kDiagonals = {1.2, 1.6, 2.2, 3.0, 4.2};  // distances, in diagonals of the pattern
constexpr double kTilted_rad = 0.52, kTiltedMuch_rad = 0.79;             // 30 and 45 degrees

// Of a board that faces the camera along `ray`: z along the ray, x level in the picture.
Matrix3d Facing(const Vector3d& ray) {
  Matrix3d R;
  R.col(2) = ray;
  R.col(0) = Vector3d::UnitY().cross(ray).normalized();
  R.col(1) = ray.cross(R.col(0));
  return R;
}

Vector3d RayOf(const Stand& stand) {
  return {std::cos(stand.up_rad) * std::sin(stand.right_rad), -std::sin(stand.up_rad),
          std::cos(stand.up_rad) * std::cos(stand.right_rad)};
}

std::array<Vector3d, 4> OuterCorners(const Target& board) {
  const Vector3d middle = CentreOf(board);
  const Eigen::Vector2d half = PatternSize_m(board) / 2;
  return {middle + Vector3d(-half.x(), -half.y(), 0), middle + Vector3d(half.x(), -half.y(), 0),
          middle + Vector3d(half.x(), half.y(), 0), middle + Vector3d(-half.x(), half.y(), 0)};
}

bool LiesInPicture(const PlannedCamera& camera, const Eigen::Vector2d& uv_px) {
  const double x = kBorder_ratio * camera.width_px, y = kBorder_ratio * camera.height_px;
  return uv_px.x() > x && uv_px.y() > y && uv_px.x() < camera.width_px - 1 - x && uv_px.y() < camera.height_px - 1 - y;
}

// Squares along both sides of the pattern.
Eigen::Vector2d SquaresOf(const Target& board) { return (PatternSize_m(board) / board.square_m).cwiseMax(1.0); }

struct Tilt {
  double right_rad, up_rad;
};
constexpr std::array<Tilt, 9> kTilts = {{{0, 0},
                                         {-kTilted_rad, 0},
                                         {kTilted_rad, 0},
                                         {0, kTilted_rad},
                                         {0, -kTilted_rad},
                                         {-kTiltedMuch_rad, 0},
                                         {kTiltedMuch_rad, 0},
                                         {0, kTiltedMuch_rad},
                                         {0, -kTiltedMuch_rad}}};

bool SaysSomething(const PlannedRig& rig, const PlannedCapture& capture) {
  return capture.looks.size() > 1 || std::any_of(capture.looks.begin(), capture.looks.end(), [&](const auto& look) {
           return (rig.cameras[look.camera].lens_sigma.array() > 0).any();
         });
}

// Half-way between where two cameras look, and above and below it: where they overlap, if they do.
void AppendBetween(const PlannedCamera& camera, const PlannedCamera& other, std::vector<Vector3d>& rays) {
  constexpr double kOverlapCosine = -0.2, kBeside_rad = 0.2;
  const Vector3d ahead = Vector3d::UnitZ(),
                 other_ahead = (camera.T_ref_camera.Inverse() * other.T_ref_camera).R().col(2);
  if (ahead.dot(other_ahead) < kOverlapCosine) return;
  const Vector3d between = (ahead + other_ahead).normalized();
  for (const double up_rad : {-kBeside_rad, 0.0, kBeside_rad})
    rays.push_back(Eigen::AngleAxisd(up_rad, Vector3d::UnitX()) * between);
}

// Unit, in the camera.
std::vector<Vector3d> RaysOf(const PlannedRig& rig, std::size_t camera, std::size_t board) {
  const PlannedCamera& one = rig.cameras[camera];
  std::vector<Vector3d> rays;
  for (const double down : kDown)
    for (const double across : kAcross)
      if (const auto ray =
              Unproject(one.model, one.intrinsics, {across * (one.width_px - 1), down * (one.height_px - 1)}))
        rays.push_back(*ray);
  for (std::size_t other = 0; other < rig.cameras.size(); ++other)
    if (other != camera &&
        std::binary_search(rig.cameras[other].boards.begin(), rig.cameras[other].boards.end(), board))
      AppendBetween(one, rig.cameras[other], rays);
  return rays;
}

// Of one place in the picture.
void AppendAlong(const PlannedRig& rig, std::size_t board, std::size_t camera, const Vector3d& ray,
                 std::vector<Candidate>& candidates) {
  const double diagonal_m = PatternSize_m(rig.boards[board]).norm();
  for (const double diagonals : kDiagonals)
    for (const Tilt& tilt : kTilts)
      if (auto candidate = CandidateAt(rig, board, camera,
                                       {std::atan2(ray.x(), ray.z()), std::asin(std::clamp(-ray.y(), -1.0, 1.0)),
                                        diagonals * diagonal_m, tilt.right_rad, tilt.up_rad}))
        candidates.push_back(*std::move(candidate));
}

}  // namespace

Se3 PoseOf(const Stand& stand, const Target& board) {
  const Vector3d ray = RayOf(stand);
  const Matrix3d tilted = (Eigen::AngleAxisd(stand.tilt_right_rad, Vector3d::UnitY()) *
                           Eigen::AngleAxisd(stand.tilt_up_rad, Vector3d::UnitX()))
                              .toRotationMatrix();
  const Eigen::Quaterniond q(Matrix3d(Facing(ray) * tilted));
  return Se3{stand.distance_m * ray - q * CentreOf(board), q}.Normalized();
}

Stand StandOf(const Se3& T_camera_board, const Target& board) {
  const Vector3d middle = T_camera_board * CentreOf(board);
  Stand stand;
  stand.distance_m = middle.norm();
  const Vector3d ray = middle / std::max(stand.distance_m, 1e-12);
  stand.right_rad = std::atan2(ray.x(), ray.z());
  stand.up_rad = std::asin(std::clamp(-ray.y(), -1.0, 1.0));
  const Vector3d normal = Facing(ray).transpose() * T_camera_board.R().col(2);
  stand.tilt_right_rad = std::atan2(normal.x(), normal.z());
  stand.tilt_up_rad = std::asin(std::clamp(-normal.y(), -1.0, 1.0));
  return stand;
}

bool SeesWhole(const PlannedCamera& camera, const Target& board, const Se3& T_camera_board) {
  const Vector3d middle = T_camera_board * CentreOf(board);
  if (T_camera_board.R().col(2).dot(middle) < kObliqueCosine * middle.norm()) return false;
  std::array<Eigen::Vector2d, 4> seen;
  const std::array<Vector3d, 4> outer = OuterCorners(board);
  for (std::size_t i = 0; i < 4; ++i) {
    const Projection at = Project(camera.model, camera.intrinsics, T_camera_board * outer[i], false);
    if (!at.in_front || !LiesInPicture(camera, at.uv_px)) return false;
    seen[i] = at.uv_px;
  }
  const Eigen::Vector2d squares = SquaresOf(board);
  const double across_px = std::min((seen[1] - seen[0]).norm(), (seen[2] - seen[3]).norm()) / squares.x();
  const double down_px = std::min((seen[3] - seen[0]).norm(), (seen[2] - seen[1]).norm()) / squares.y();
  return std::min(across_px, down_px) >= kSquareMin_px;
}

PlannedCapture CaptureAt(const PlannedRig& rig, std::size_t board, std::size_t camera, const Se3& T_camera_board) {
  PlannedCapture capture{board, {}};
  const Se3 T_ref_board = rig.cameras[camera].T_ref_camera * T_camera_board;
  for (std::size_t other = 0; other < rig.cameras.size(); ++other) {
    const PlannedCamera& one = rig.cameras[other];
    if (!std::binary_search(one.boards.begin(), one.boards.end(), board)) continue;
    const Se3 T_other_board = one.T_ref_camera.Inverse() * T_ref_board;
    if (SeesWhole(one, rig.boards[board], T_other_board)) capture.looks.push_back({other, T_other_board, {}});
  }
  return capture;
}

std::optional<Candidate> CandidateAt(const PlannedRig& rig, std::size_t board, std::size_t camera, const Stand& stand) {
  Candidate candidate{camera, stand, CaptureAt(rig, board, camera, PoseOf(stand, rig.boards[board]))};
  const std::vector<PlannedLook>& looks = candidate.capture.looks;
  const bool is_seen = std::any_of(looks.begin(), looks.end(), [&](const auto& look) { return look.camera == camera; });
  if (!is_seen || !SaysSomething(rig, candidate.capture)) return std::nullopt;
  return candidate;
}

std::vector<Candidate> CandidatesOf(const PlannedRig& rig) {
  std::vector<Candidate> candidates;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera)
    for (const std::size_t board : rig.cameras[camera].boards)
      for (const Vector3d& ray : RaysOf(rig, camera, board)) AppendAlong(rig, board, camera, ray, candidates);
  return candidates;
}

}  // namespace rigcal::calib::placement
