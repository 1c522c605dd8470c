// A camera's lens on a grid of pixels: where each looks and how dark the border is. Pictures are drawn in tiles of 16 x
// 16 pixels, in which everything is taken as quadratic between the grid's nodes, 8 pixels apart (1e-3 px).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "client/sim/rig/rig.h"

namespace rigcal::sim {

constexpr int kTile = 16;         // pixels
constexpr int kNode = kTile / 2;  // pixels between nodes

struct RayGrid {
  int tiles_x = 0, tiles_y = 0;
  std::vector<Eigen::Vector3f> rays;  // in the camera's frame, row by row
  std::vector<float> brightness;      // 0 to 1

  // `shift_px`: of the whole picture.
  explicit RayGrid(const CameraTruth& camera, const Eigen::Vector2d& shift_px = Eigen::Vector2d::Zero());
  [[nodiscard]] std::size_t NodeIndex(int node_x, int node_y) const {
    return static_cast<std::size_t>(node_y) * static_cast<std::size_t>(2 * tiles_x + 1) +
           static_cast<std::size_t>(node_x);
  }
};

}  // namespace rigcal::sim
