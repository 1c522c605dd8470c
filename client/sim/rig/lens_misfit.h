// A lens that bends the picture in a way that no lens model describes: a fixed smooth field of shifts, drawn at random.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace rigcal::sim {

// A plane wave over the picture.
struct Wave {
  Eigen::Vector2d cycles_per_px = Eigen::Vector2d::Zero();
  double phase_rad = 0.0, amplitude_px = 0.0;
};

struct LensMisfit {
  std::vector<Wave> along_u, along_v;  // of the shift; none: a lens as its model says

  [[nodiscard]] bool empty() const { return along_u.empty() && along_v.empty(); }  // nothing is bent
  // What is added to the pixel at which the model sees a point.
  [[nodiscard]] Eigen::Vector2d At(const Eigen::Vector2d& uv_px) const;
  // Where the model would see what this lens shows at a pixel.
  [[nodiscard]] Eigen::Vector2d Straightened(const Eigen::Vector2d& uv_px) const;
};

// Each coordinate of the shift has this rms over the picture, in waves of which 1.5 to 3 fit into it; 0: none.
[[nodiscard]] LensMisfit DrawLensMisfit(double rms_px, int width_px, int height_px, std::uint64_t key);

}  // namespace rigcal::sim
