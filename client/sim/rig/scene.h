// What there is to see: flat rectangles in the world, for pictures and for beams alike.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "client/sim/rig/printed_pattern.h"
#include "client/sim/rig/rig.h"

namespace rigcal::sim {

// Which surfaces hide which, where depth alone does not say: patches lie on the room's faces.
enum class Layer { kRoom, kPatch, kObject };

// A rectangle: points middle + a u + b v with |a|, |b| up to half_m; u and v are unit and perpendicular. Seen from the
// side that `outward` points to; a board from its back is a plain plate.
struct Panel {
  Eigen::Vector3d middle_m, u, v, outward;
  Eigen::Vector2d half_m;
  Layer layer = Layer::kObject;
  Colour colour = Colour::Constant(0.5);
  int board_idx = -1;          // of Scene::boards; otherwise plain
  Bend bend = {};              // of a board
  double stretch_ratio = 1.0;  // of its print along a
};

struct Scene {
  std::vector<Panel> panels;
  std::vector<Target> boards;
  std::vector<PrintedPattern> prints;  // of the boards; empty of checkerboards
  Eigen::Vector3d lamp_m;
};

constexpr double kWhite = 0.86, kBlack = 0.05;  // of printed boards

// Room, objects and the boards where the rig has them at first. `rig` must be valid.
[[nodiscard]] Scene SceneOf(const Rig& rig);
// How much farther along a ray a bent panel is than its plane, over the distance of the plane, where the ray meets the
// plane; `height_m`: of the ray's origin over the plane.
[[nodiscard]] double BendAlong(const Panel& panel, const Eigen::Vector2d& ab_m, double height_m);
// Light that a surface sends back to every side, over what it would under the lamp.
[[nodiscard]] double ShadeAt(const Scene& scene, const Eigen::Vector3d& point_m, const Eigen::Vector3d& outward);
[[nodiscard]] Colour AlbedoAt(const Scene& scene, const Panel& panel, const Eigen::Vector2d& plate_ab_m);

// The nearest surface along a ray from a point; distance in lengths of `direction`.
struct Hit {
  int panel_idx = -1;  // none
  double distance = 0.0;
  Eigen::Vector2d ab_m = Eigen::Vector2d::Zero();
};
// Of panels seen from their front; plates also from behind.
[[nodiscard]] Hit NearestHit(const Scene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction);

}  // namespace rigcal::sim
