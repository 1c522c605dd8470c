// Draws 16 x 16 pixels: every panel in them with the lens' blur worked into its edges, so that nothing is sampled more
// than once and corners are where geometry puts them.
#pragma once

#include <array>
#include <vector>

#include "client/sim/views/panel_view.h"
#include "client/sim/views/soft_edge.h"

namespace rigcal::sim {

struct Tile {
  static constexpr int kPixels = kTile * kTile;
  std::array<float, kPixels> red, green, blue;  // 0 to 1
};

// What is fixed for one picture.
struct Painter {
  const Scene& scene;
  const RayGrid& grid;
  const Eigen::Vector3d from_m;  // the camera's place
  const Eigen::Matrix3d R_world_cam;
  float blur_px;
};

// `views`: those that may show in this tile.
void DrawTile(const Painter& painter, const std::vector<const PanelView*>& views, int tile_x, int tile_y, Tile& tile);

}  // namespace rigcal::sim
