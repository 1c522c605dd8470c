#include "client/sim/views/scan.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "client/sim/rig/random.h"

namespace rigcal::sim {
namespace {

static_assert(std::endian::native == std::endian::little, "a binary PCD is little endian");

// Noise is drawn firing by firing, so that a part of a scan has the whole scan's.
double Noise(std::uint64_t key, int firing, int ring) {
  return Random(key + static_cast<std::uint64_t>(firing) * 4096 + static_cast<std::uint64_t>(ring)).Normal();
}

// A beam has a width: at an edge it meets two surfaces, and some of what comes back is between them.
constexpr double kBeamWidth_rad = 3e-3, kEdge_m = 0.05;

std::optional<double> MixedRange_m(const Scene& scene, double ratio, const Eigen::Vector3d& from_m,
                                   const Eigen::Vector3d& direction, const Hit& hit, std::uint64_t key) {
  Random random(key);
  const Eigen::Vector3d drawn = random.Normals<3>();
  const Eigen::Vector3d aside = (drawn - drawn.dot(direction) * direction).normalized();
  const Hit beside = NearestHit(scene, from_m, direction + kBeamWidth_rad / 2 * aside);
  if (beside.panel_idx < 0 || std::abs(beside.distance - hit.distance) < kEdge_m) return std::nullopt;
  if (random.Uniform() >= ratio) return std::nullopt;
  return hit.distance + random.Uniform() * (beside.distance - hit.distance);
}

// Of a beam that meets a surface aslant; `cosine` of the incidence.
double IncidenceBias_m(const LidarTruth& lidar, double cosine) { return lidar.incidence_bias_m * 2 * (1 - cosine); }

template <typename T>
void Append(std::string& bytes, const T& value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

}  // namespace

Beams::Beams(const LidarTruth& lidar) {
  for (const double elevation : lidar.elevations_rad) rings.emplace_back(std::cos(elevation), std::sin(elevation));
  for (int firing = 0; firing < lidar.firings_per_turn; ++firing) {
    const double azimuth = -2 * M_PI * firing / lidar.firings_per_turn;  // clockwise, as seen from above
    firings.emplace_back(std::cos(azimuth), std::sin(azimuth));
  }
}

std::vector<ScanPoint> Scan(const Scene& scene, const LidarTruth& lidar, const Se3& T_world_lidar,
                            const std::vector<double>& beam_bias_m, std::uint64_t key,
                            const std::optional<Cone>& towards) {
  std::vector<ScanPoint> points;
  const Eigen::Matrix3d R = T_world_lidar.R();
  const Beams beams(lidar);
  const int rings = static_cast<int>(lidar.elevations_rad.size());
  for (int firing = 0; firing < lidar.firings_per_turn; ++firing)
    for (int ring = 0; ring < rings; ++ring) {
      const Eigen::Vector3d direction = beams.Direction(firing, ring);
      if (towards && direction.dot(towards->axis) < towards->cosine) continue;
      const Eigen::Vector3d ray = R * direction;
      Hit hit = NearestHit(scene, T_world_lidar.p_m, ray);
      if (hit.panel_idx < 0 || hit.distance < lidar.range_min_m || hit.distance > lidar.range_max_m) continue;
      const double bias_m = beam_bias_m.empty() ? 0.0 : beam_bias_m[static_cast<std::size_t>(ring)];
      const Panel& panel = scene.panels[static_cast<std::size_t>(hit.panel_idx)];
      if (!panel.bend.is_flat())
        hit.distance *= 1 + BendAlong(panel, hit.ab_m, panel.outward.dot(T_world_lidar.p_m - panel.middle_m));
      std::optional<double> mixed_m;
      if (lidar.mixed_pixels_ratio > 0)
        mixed_m = MixedRange_m(
            scene, lidar.mixed_pixels_ratio, T_world_lidar.p_m, ray, hit,
            KeyOf(key, "mixed", {}, static_cast<std::uint64_t>(firing) * 4096 + static_cast<std::uint64_t>(ring)));
      const double range_m = mixed_m.value_or(hit.distance);
      const double measured_m = range_m + bias_m + lidar.range_sigma_m * Noise(key, firing, ring) +
                                IncidenceBias_m(lidar, std::abs(panel.outward.dot(ray)));
      points.push_back({measured_m * direction, range_m,
                        static_cast<float>(std::floor(255 * AlbedoAt(scene, panel, hit.ab_m).mean())), ring,
                        mixed_m ? -1 : hit.panel_idx});
    }
  return points;
}

std::string PcdOf(const std::vector<ScanPoint>& points) {
  const std::string count = std::to_string(points.size());
  std::string bytes =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity ring\nSIZE 4 4 4 4 2\n"
      "TYPE F F F F U\nCOUNT 1 1 1 1 1\nWIDTH " +
      count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  bytes.reserve(bytes.size() + 18 * points.size());
  for (const ScanPoint& point : points) {
    for (int k = 0; k < 3; ++k) Append(bytes, static_cast<float>(point.p_lidar[k]));
    Append(bytes, point.intensity);
    Append(bytes, static_cast<std::uint16_t>(point.ring));
  }
  return bytes;
}

}  // namespace rigcal::sim
