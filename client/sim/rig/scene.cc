#include "client/sim/rig/scene.h"

#include <cmath>
#include <limits>

#include "client/sim/rig/random.h"

namespace rigcal::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Panel Face(const Vector3d& middle_m, const Vector3d& outward, const Vector3d& u, const Vector3d& size_m) {
  Panel panel;
  panel.middle_m = middle_m;
  panel.outward = outward;
  panel.u = u;
  panel.v = outward.cross(u);
  panel.half_m = size_m.head<2>() / 2;
  return panel;
}

// The six faces of a box, seen from outside (side 1) or inside (side -1).
void AppendFaces(const Box& box, double side, Layer layer, std::vector<Panel>& panels) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(box.yaw_rad, Vector3d::UnitZ()).toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const int across = (axis + 1) % 3, other = (axis + 2) % 3;
      const Vector3d n = sign * R.col(axis);
      Panel panel = Face(box.centre_m + n * box.size_m[axis] / 2, side * n, R.col(across),
                         {box.size_m[across], box.size_m[other], 0});
      panel.layer = layer;
      panel.colour = box.colour;
      panels.push_back(panel);
    }
}

void AppendRoom(const Room& room, std::vector<Panel>& panels) {
  const Box walls{{0, 0, room.size_m.z() / 2}, room.size_m, 0.0, {0.62, 0.60, 0.56}};
  AppendFaces(walls, -1, Layer::kRoom, panels);
  panels[4].colour = {0.72, 0.72, 0.71};  // ceiling
  panels[5].colour = {0.36, 0.33, 0.31};  // floor
}

Panel DrawPatch(const Panel& wall, std::uint64_t key) {
  Random random(key);
  Panel patch = wall;
  patch.layer = Layer::kPatch;
  for (int k = 0; k < 2; ++k) patch.half_m[k] = random.Uniform(0.08, 0.32);
  for (int k = 0; k < 3; ++k) patch.colour[k] = random.Uniform(0.05, 0.95);
  Vector2d at_m;
  for (int k = 0; k < 2; ++k) at_m[k] = (wall.half_m[k] - patch.half_m[k]) * random.Uniform(-1, 1);
  patch.middle_m += at_m.x() * wall.u + at_m.y() * wall.v;
  return patch;
}

// The same whatever the seed: they belong to the room.
void AppendPatches(int per_wall, std::vector<Panel>& panels) {
  const std::vector<Panel> walls = panels;
  for (std::size_t wall = 0; wall < walls.size(); ++wall)
    for (int i = 0; i < per_wall; ++i)
      panels.push_back(DrawPatch(walls[wall], KeyOf(wall, "patch", {}, static_cast<std::uint64_t>(i))));
}

Panel PlateOf(const RigBoard& board, int board_idx) {
  const Eigen::Matrix3d R = board.T_world_plate.R();
  Panel panel = Face(board.T_world_plate.p_m, -R.col(2), R.col(0), Vector3d::Zero());
  panel.v = R.col(1);
  panel.half_m = *board.target.plate_m / 2;
  panel.colour = Colour::Constant(0.45);  // of its back
  panel.board_idx = board_idx;
  panel.bend = board.bend;
  panel.stretch_ratio = board.stretch_ratio;
  return panel;
}

double GreyOfCheckerboard(const Target& board, const Vector2d& ab_m) {
  const Vector2d counts(board.cols, board.rows);
  const Vector2d from_middle_m = ab_m + board.plate_offset_m.value_or(Vector2d::Zero());
  const Vector2d squares = from_middle_m / board.square_m + (counts - Vector2d::Ones()) / 2;  // corner (0, 0) at 0, 0
  if ((squares.array() < -1).any() || (squares.array() > counts.array()).any()) return kWhite;
  const int parity = static_cast<int>(std::floor(squares.x())) + static_cast<int>(std::floor(squares.y()));
  return parity % 2 == 0 ? kBlack : kWhite;
}

}  // namespace

Scene SceneOf(const Rig& rig) {
  Scene scene;
  scene.lamp_m = {0.3, -0.2, rig.room.size_m.z() - 0.2};
  AppendRoom(rig.room, scene.panels);
  AppendPatches(rig.room.patches_per_wall, scene.panels);
  for (const Box& box : rig.room.boxes) AppendFaces(box, 1, Layer::kObject, scene.panels);
  for (const RigBoard& board : rig.boards) {
    scene.panels.push_back(PlateOf(board, static_cast<int>(scene.boards.size())));
    scene.boards.push_back(board.target);
    const bool is_checkerboard = board.target.kind == TargetKind::kCheckerboard;
    scene.prints.push_back(is_checkerboard ? PrintedPattern() : PrintedPattern::Of(board.target).value());
  }
  return scene;
}

double BendAlong(const Panel& panel, const Vector2d& ab_m, double height_m) { return panel.bend.At(ab_m) / height_m; }

double ShadeAt(const Scene& scene, const Vector3d& point_m, const Vector3d& outward) {
  const Vector3d light = scene.lamp_m - point_m;
  const double length = light.norm();
  return 0.72 + 0.28 * std::abs(outward.dot(light)) / std::max(length, 1e-3);
}

Colour AlbedoAt(const Scene& scene, const Panel& panel, const Vector2d& plate_ab_m) {
  if (panel.board_idx < 0) return panel.colour;
  const Vector2d ab_m(plate_ab_m.x() / panel.stretch_ratio, plate_ab_m.y());
  const auto idx = static_cast<std::size_t>(panel.board_idx);
  const Target& board = scene.boards[idx];
  if (board.kind == TargetKind::kCheckerboard) return Colour::Constant(GreyOfCheckerboard(board, ab_m));
  return Colour::Constant(scene.prints[idx].IsBlack(ab_m) ? kBlack : kWhite);
}

Hit NearestHit(const Scene& scene, const Vector3d& from_m, const Vector3d& direction) {
  Hit nearest;
  nearest.distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.panels.size(); ++i) {
    const Panel& panel = scene.panels[i];
    const double facing = panel.outward.dot(direction);
    // Boxes are closed and the room is seen from inside: only plates have a back.
    if (facing == 0 || (facing > 0 && panel.board_idx < 0)) continue;
    const Vector3d offset = panel.middle_m - from_m;
    const double distance = panel.outward.dot(offset) / facing;
    // A patch does not hide the wall that it lies on, but is it.
    const double slack = panel.layer == Layer::kPatch ? 1e-9 * distance : 0;
    if (!(distance > 0 && distance <= nearest.distance + slack)) continue;
    const Vector3d on_panel = distance * direction - offset;
    const Vector2d ab_m(panel.u.dot(on_panel), panel.v.dot(on_panel));
    if ((ab_m.cwiseAbs() - panel.half_m).maxCoeff() <= 0) nearest = {static_cast<int>(i), distance, ab_m};
  }
  if (nearest.panel_idx < 0) nearest.distance = 0;
  return nearest;
}

}  // namespace rigcal::sim
