// One turn of a lidar: every beam's nearest surface, with range noise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/sim/rig/scene.h"
#include "server/math/se3.h"

namespace rigcal::sim {

struct ScanPoint {
  Eigen::Vector3d p_lidar;  // metres, with noise
  double range_m = 0;       // true, without bias and noise
  float intensity = 0;      // 0 to 255, of the surface
  int ring = 0;             // beam, 0 the lowest
  int panel_idx = -1;       // of the scene: what it lies on; -1: between two surfaces
};

// Which way each beam goes at each firing.
struct Beams {
  std::vector<Eigen::Vector2d> rings, firings;  // cosine and sine of elevation, of azimuth

  // Firings go clockwise, as seen from above, from the lidar's x.
  explicit Beams(const LidarTruth& lidar);
  // Unit vector in the lidar's frame; both count from 0.
  [[nodiscard]] Eigen::Vector3d Direction(int firing, int ring) const {
    const Eigen::Vector2d &e = rings[static_cast<std::size_t>(ring)], &a = firings[static_cast<std::size_t>(firing)];
    return {e.x() * a.x(), e.x() * a.y(), e.y()};
  }
};
struct Cone {
  Eigen::Vector3d axis;
  double cosine = -1;
};
// All returns, firing by firing, rings rising. `beam_bias_m`: per ring, added to every range. `key`: of the noise.
// `towards`: only beams within the cone (a unit direction in the lidar's frame, and the cosine of half its width);
// their points are those of the whole scan.
[[nodiscard]] std::vector<ScanPoint> Scan(const Scene& scene, const LidarTruth& lidar, const Se3& T_world_lidar,
                                          const std::vector<double>& beam_bias_m, std::uint64_t key,
                                          const std::optional<Cone>& towards = {});

// PCD 0.7, binary: x y z intensity as float32, ring as uint16.
[[nodiscard]] std::string PcdOf(const std::vector<ScanPoint>& points);

}  // namespace rigcal::sim
