#include "tests/unit/calib/virtual_cell.h"

#include <algorithm>
#include <cstdio>

namespace rigcal::calib {
namespace {

constexpr double kTurn_rad = 0.3;

struct Draw {
  std::mt19937 random;
  std::normal_distribution<double> normal{0.0, 1.0};
  std::uniform_real_distribution<double> part{-1.0, 1.0};

  Eigen::Vector3d Normals(double sigma) {
    const double x = normal(random), y = normal(random), z = normal(random);
    return sigma * Eigen::Vector3d(x, y, z);
  }
  Eigen::Vector3d Parts() {
    const double x = part(random), y = part(random), z = part(random);
    return {x, y, z};
  }
};

Se3 Twisted(const Eigen::Vector3d& p_m, const Eigen::Vector3d& turn_rad) {
  const double angle_rad = turn_rad.norm();
  Se3 T;
  T.p_m = p_m;
  if (angle_rad > 0) T.q = Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, turn_rad / angle_rad));
  return T;
}

// Of the board about its centre, before the camera.
Se3 BoardBeforeCamera(const VirtualView& view, const Eigen::Vector3d& centre_cam_m, const Eigen::Vector3d& turn_rad) {
  return Twisted(centre_cam_m, turn_rad) * Se3{-CentreOf(view.board), Eigen::Quaterniond::Identity()};
}

CaptureId Numbered(std::size_t k) {
  char text[8];
  std::snprintf(text, sizeof text, "%03u", static_cast<unsigned>(k % 1000));
  return CaptureId(text);
}

}  // namespace

VirtualCell Celled(const VirtualView& view, Arm arm, int captures, unsigned seed) {
  Draw draw{std::mt19937(seed)};
  VirtualCell cell;
  cell.T_base_cam = Twisted(draw.Normals(0.8), draw.Normals(1.0));
  cell.T_flange_board = Twisted(draw.Normals(0.1), draw.Normals(1.0));
  const Eigen::Vector3d middle_cam_m(0, 0, 1.6);
  const Se3 T_base_middle =
      cell.T_base_cam * BoardBeforeCamera(view, middle_cam_m, {0.2, -0.15, 0.1}) * cell.T_flange_board.Inverse();
  for (int k = 0; k < captures; ++k) {
    const Eigen::Vector3d shift_m = 0.15 * draw.Parts();
    const Eigen::Vector3d turn_rad = draw.Normals(kTurn_rad).cwiseMax(-2 * kTurn_rad).cwiseMin(2 * kTurn_rad);
    const Se3 T_cam_board = BoardBeforeCamera(view, middle_cam_m + 2 * shift_m, turn_rad);
    Se3 T_base_flange = cell.T_base_cam * T_cam_board * cell.T_flange_board.Inverse();
    if (arm == Arm::kNoTurns) T_base_flange = {T_base_middle.p_m + shift_m, T_base_middle.q};
    if (arm == Arm::kOneAxis)
      T_base_flange = {T_base_middle.p_m + shift_m, Twisted({0, 0, 0}, {0, 0, turn_rad.z()}).q * T_base_middle.q};
    if (arm == Arm::kFirstJoint) T_base_flange = Twisted({0, 0, 0}, {0, 0, 0.5 * turn_rad.z()}) * T_base_middle;
    cell.T_base_flange.push_back(T_base_flange.Normalized());
  }
  return cell;
}

HandEyeProblem ArmAndCamera(const VirtualCell& cell, const VirtualView& view, const PoseNoise& arm, bool given,
                            unsigned seed) {
  Draw draw{std::mt19937(seed)};
  HandEyeProblem problem;
  problem.method = Method::kEyeToHand;
  problem.a.sensor.id = SensorId("arm");
  problem.a.sensor.kind = SensorKind::kTracker;
  problem.b.sensor.id = SensorId("camera");
  problem.b.board = view.board;
  problem.b.board->mounted_on = SensorId("arm");
  if (given) {
    problem.b.sensor.intrinsics = view.camera;
    problem.b.sensor.intrinsics_sigma = std::vector<double>(9, 0.0);
  }
  for (std::size_t k = 0; k < cell.T_base_flange.size(); ++k) {
    const Se3& F = cell.T_base_flange[k];
    const Eigen::Vector3d moved_m = draw.Normals(arm.translation_m), turned_rad = draw.Normals(arm.rotation_rad);
    problem.a.poses.push_back({Numbered(k), {}, (F * Twisted(moved_m, turned_rad)).Normalized()});
    const Se3 T_board_cam = (cell.T_base_cam.Inverse() * F * cell.T_flange_board).Inverse();
    problem.b.views.emplace_back(Numbered(k), SeenBy(view, T_board_cam, 0, draw.random));
  }
  return problem;
}

}  // namespace rigcal::calib
