// What one picture of a stream shows of the board: little enough to keep of every picture of a bag.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace rigcal::moments {

struct Sight {
  std::int64_t stamp_ns = 0;  // of its camera's clock
  int target_idx = -1;        // of the targets that the camera may see; -1: no board in view
  // Side by side; indices are those of TargetPoints(), ascending, kCornersKept of them at most, the same in all
  // pictures where the board is seen whole.
  int width_px = 0, height_px = 0;  // of the picture
  std::vector<int> corner_idx;
  std::vector<Eigen::Vector2f> corners_px;
  double m_per_px = 0;            // on the board
  std::optional<double> edge_px;  // how wide its edges are (client/check/edge_width.h)
  double bright_ratio = 0;        // of places on the board that are as bright as the picture can be
  double contrast_grey = 0;       // between its dark and its bright places

  [[nodiscard]] bool found() const { return target_idx >= 0; }
};

constexpr std::size_t kCornersKept = 24;

// How far the board moved between two pictures of one camera: root mean square over its corners.
struct Shift {
  double px = 0, m = 0;  // in the picture; on the board, across the view
};
// Nothing where they do not show the same corners, three at least.
[[nodiscard]] std::optional<Shift> ShiftBetween(const Sight& a, const Sight& b);

}  // namespace rigcal::moments
