// A panel as one camera at one place sees it: plane coordinates a, b of a ray r are Na.r / D.r and Nb.r / D.r.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "client/sim/rig/scene.h"
#include "client/sim/views/ray_grid.h"
#include "server/math/se3.h"

namespace rigcal::sim {

struct PanelView {
  const Panel* panel = nullptr;
  Eigen::Vector3f Na, Nb, D;  // D.r is positive before the camera
  float plane_m = 0;          // distance of the plane: depth along r is plane_m / D.r
  float least = 0;            // half of the smallest D.r of a ray that meets the panel: below it, near the plane's
                              // horizon, coordinates are far beyond the panel with it as well
  bool is_back = false;       // of a plate
  Eigen::Vector3f from_m{0, 0, 1};  // of the camera along u, v and outward, from the panel's middle
};

// Panels that face the camera.
[[nodiscard]] std::vector<PanelView> PanelViews(const Scene& scene, const Se3& T_world_cam);

// What part of a panel a bundle of rays meets.
enum class Cover { kNone, kPart, kWhole };
// `soft_px`: how far beyond its border a panel still shows, and `pitch_px` the distance of the rays. Nine rays, 3 x 3.
[[nodiscard]] Cover CoverOf(const PanelView& view, const Eigen::Vector3f (&rays)[9], float pitch_px, float soft_px);

}  // namespace rigcal::sim
