#include "client/sim/views/ray_grid.h"

#include <cmath>

#include "client/sim/rig/lens.h"

namespace rigcal::sim {

RayGrid::RayGrid(const CameraTruth& camera, const Eigen::Vector2d& shift_px)
    : tiles_x((camera.width_px + kTile - 1) / kTile), tiles_y((camera.height_px + kTile - 1) / kTile) {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y <= 2 * tiles_y; ++y)
    for (int x = 0; x <= 2 * tiles_x; ++x)
      pixels.push_back(camera.misfit.Straightened(Eigen::Vector2d(x * kNode, y * kNode) - shift_px));
  for (const Eigen::Vector3d& ray : RaysOf(camera.intrinsics, pixels)) {
    rays.push_back(ray.cast<float>());
    const double cosine = ray.z() / ray.norm();
    brightness.push_back(static_cast<float>(1 - camera.vignetting_ratio * (1 - std::pow(cosine, 4))));
  }
}

}  // namespace rigcal::sim
