#include "server/calib/placement/candidates.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigcal::calib::placement {
namespace {

using Eigen::Vector3d;

constexpr double kBorder_ratio = 0.03;  // of the picture's side: corners there are found badly
constexpr double kBeside_ratio = 0.07;  // of the pattern's diagonal, held so far beside its place: a hand's breadth
constexpr double kObliqueCosine = 0.5;  // 60 degrees: beyond, corners are found badly
constexpr double kSquareMin_px = 10.0;  // of the shorter way across a square
constexpr std::array<double, 5> kAcross = {0.2, 0.35, 0.5, 0.65, 0.8};  // of the picture's width
constexpr std::array<double, 3> kDown = {0.25, 0.5, 0.75};
constexpr std::array<double, 5> kDiagonals = {1.2, 1.6, 2.2, 3.0, 4.2};  // distances, in diagonals of the pattern

// Of the pattern and what a hand may be off, metres.
Eigen::Vector2d HeldSize_m(const Target& board) {
  const Eigen::Vector2d size_m = PatternSize_m(board);
  return size_m.array() + 2 * kBeside_ratio * size_m.norm();
}

std::array<Vector3d, 4> OuterCorners(const Target& board) {
  const Vector3d middle = CentreOf(board);
  const Eigen::Vector2d half = HeldSize_m(board) / 2;
  return {middle + Vector3d(-half.x(), -half.y(), 0), middle + Vector3d(half.x(), -half.y(), 0),
          middle + Vector3d(half.x(), half.y(), 0), middle + Vector3d(-half.x(), half.y(), 0)};
}

bool LiesInPicture(const PlannedCamera& camera, const Eigen::Vector2d& uv_px) {
  const double x = kBorder_ratio * camera.width_px, y = kBorder_ratio * camera.height_px;
  return uv_px.x() > x && uv_px.y() > y && uv_px.x() < camera.width_px - 1 - x && uv_px.y() < camera.height_px - 1 - y;
}

// Squares along both sides between the outer corners.
Eigen::Vector2d SquaresOf(const Target& board) { return (HeldSize_m(board) / board.square_m).cwiseMax(1.0); }

// Facing the camera, and 40 degrees to each side and each corner.
struct Tilt {
  double right_rad, up_rad;
};
constexpr double kTilted_rad = 0.7, kAslant_rad = 0.5;
constexpr std::array<Tilt, 9> kTilts = {{{0, 0},
                                         {-kTilted_rad, 0},
                                         {kTilted_rad, 0},
                                         {0, -kTilted_rad},
                                         {0, kTilted_rad},
                                         {-kAslant_rad, -kAslant_rad},
                                         {-kAslant_rad, kAslant_rad},
                                         {kAslant_rad, -kAslant_rad},
                                         {kAslant_rad, kAslant_rad}}};

bool SaysSomething(const PlannedRig& rig, const PlannedCapture& capture) {
  return capture.looks.size() > 1 || std::any_of(capture.looks.begin(), capture.looks.end(), [&](const auto& look) {
           return (rig.cameras[look.camera].lens_sigma.array() > 0).any();
         });
}

// The middle of a board, in the camera before which it is told.
Stand StandAt(const Vector3d& middle_m) {
  const Vector3d ray = middle_m.normalized();
  return {std::atan2(ray.x(), ray.z()), std::asin(std::clamp(-ray.y(), -1.0, 1.0)), middle_m.norm()};
}

// Middles of boards `distance_m` away all over the camera's picture, in the camera.
std::vector<Vector3d> MiddlesBefore(const PlannedCamera& camera, double distance_m) {
  std::vector<Vector3d> middles_m;
  for (const double down : kDown)
    for (const double across : kAcross)
      if (const auto ray = Unproject(camera.model, camera.intrinsics,
                                     {across * (camera.width_px - 1), down * (camera.height_px - 1)}))
        middles_m.push_back(distance_m * *ray);
  return middles_m;
}

// Half-way between where two cameras look, up and down there: where they overlap, if they do. In `camera`.
std::vector<Vector3d> MiddlesBetween(const PlannedCamera& camera, const PlannedCamera& other, double distance_m) {
  constexpr double kOverlapCosine = -0.2, kUp_ratio = 0.2;
  const Se3 T_camera_other = camera.T_ref_camera.Inverse() * other.T_ref_camera;
  const Vector3d ahead = Vector3d::UnitZ(), other_ahead = T_camera_other.R().col(2);
  if (ahead.dot(other_ahead) < kOverlapCosine) return {};
  const Vector3d between = (ahead + other_ahead).normalized();
  const Vector3d apart = (ahead - other_ahead).norm() > 0.1 ? Vector3d(other_ahead - ahead) : T_camera_other.p_m;
  const Vector3d up = between.cross(apart).normalized();
  std::vector<Vector3d> middles_m;
  for (const int step : {-2, -1, 0, 1, 2})
    middles_m.emplace_back(0.5 * T_camera_other.p_m + distance_m * (between + step * kUp_ratio * up).normalized());
  return middles_m;
}

// At one place, tilted to each side, upright and on its side.
void AppendAt(const PlannedRig& rig, std::size_t board, std::size_t camera, const Vector3d& middle_m,
              std::vector<Candidate>& candidates) {
  Stand stand = StandAt(middle_m);
  for (const Tilt& tilt : kTilts)
    for (const double turned_rad : {0.0, M_PI / 2}) {
      stand.tilt_right_rad = tilt.right_rad, stand.tilt_up_rad = tilt.up_rad, stand.turned_rad = turned_rad;
      if (auto candidate = CandidateAt(rig, board, camera, stand)) candidates.push_back(*std::move(candidate));
    }
}

bool MaySee(const PlannedCamera& camera, std::size_t board) {
  return std::binary_search(camera.boards.begin(), camera.boards.end(), board);
}

void AppendBefore(const PlannedRig& rig, std::size_t board, std::size_t camera, std::vector<Candidate>& candidates) {
  const double diagonal_m = PatternSize_m(rig.boards[board]).norm();
  for (const double diagonals : kDiagonals) {
    std::vector<Vector3d> middles_m = MiddlesBefore(rig.cameras[camera], diagonals * diagonal_m);
    for (std::size_t other = camera + 1; other < rig.cameras.size(); ++other)
      if (MaySee(rig.cameras[other], board))
        for (const Vector3d& middle_m : MiddlesBetween(rig.cameras[camera], rig.cameras[other], diagonals * diagonal_m))
          middles_m.push_back(middle_m);
    for (const Vector3d& middle_m : middles_m) AppendAt(rig, board, camera, middle_m, candidates);
  }
}

}  // namespace

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
    if (!MaySee(one, board)) continue;
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
    for (const std::size_t board : rig.cameras[camera].boards) AppendBefore(rig, board, camera, candidates);
  return candidates;
}

}  // namespace rigcal::calib::placement
