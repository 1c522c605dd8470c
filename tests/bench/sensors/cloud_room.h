// A room with a free-standing plate, scanned and photographed: what each point and pixel shows is known exactly.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "server/base/process/parallel_for.h"
#include "server/cloud/camera_view.h"

namespace rigcal::cloud {

// A box of 8 x 6 x 3 m around the lidar, and plates in front of its walls. Colours are even per surface.
struct CloudRoom {
  struct Plate {
    Eigen::Vector3d middle_m, half_u_m, half_v_m;  // half sides, at right angles
    Rgb rgb;
  };
  Eigen::Vector3d low_m{-4, -3, -1.2}, high_m{4, 3, 1.8};
  std::vector<Plate> plates;

  static constexpr int kWallColours = 6;
  [[nodiscard]] static Rgb WallColour(int wall) {
    constexpr std::uint8_t kColours[kWallColours][3] = {{200, 90, 90},  {90, 90, 200},   {200, 180, 80},
                                                        {120, 70, 160}, {110, 110, 110}, {180, 180, 190}};
    return {kColours[wall][0], kColours[wall][1], kColours[wall][2]};
  }

  struct Hit {
    double distance_m = std::numeric_limits<double>::infinity();  // in units of the ray
    int surface = -1;                                             // walls 0 to 5, then the plates
  };
  // Where a ray that begins inside the room ends.
  [[nodiscard]] Hit Trace(const Eigen::Vector3d& from_m, const Eigen::Vector3d& ray) const {
    Hit hit;
    for (int axis = 0; axis < 3; ++axis) {
      if (ray[axis] == 0) continue;
      const double t = ((ray[axis] > 0 ? high_m : low_m)[axis] - from_m[axis]) / ray[axis];
      if (t < hit.distance_m) hit = {t, 2 * axis + (ray[axis] > 0 ? 1 : 0)};
    }
    for (std::size_t i = 0; i < plates.size(); ++i) {
      const Plate& plate = plates[i];
      const Eigen::Vector3d normal = plate.half_u_m.cross(plate.half_v_m);
      const double t = normal.dot(plate.middle_m - from_m) / normal.dot(ray);
      if (!(t > 1e-9) || t >= hit.distance_m) continue;
      const Eigen::Vector3d at = from_m + t * ray - plate.middle_m;
      if (std::abs(at.dot(plate.half_u_m)) <= plate.half_u_m.squaredNorm() &&
          std::abs(at.dot(plate.half_v_m)) <= plate.half_v_m.squaredNorm())
        hit = {t, kWallColours + static_cast<int>(i)};
    }
    return hit;
  }
  [[nodiscard]] Rgb ColourOf(int surface) const {
    return surface < kWallColours ? WallColour(surface) : plates[static_cast<std::size_t>(surface - kWallColours)].rgb;
  }

  // Beams evenly over the sphere (a golden spiral) from the origin; `surfaces`: what each point lies on.
  [[nodiscard]] Cloud Scan(std::size_t count, std::vector<int>& surfaces) const {
    Cloud cloud;
    cloud.points_m.resize(count), surfaces.resize(count);
    ParallelFor(count, [&](std::size_t i) {
      const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
      const double angle = std::fmod(2.399963229728653 * static_cast<double>(i), 2 * M_PI), r = std::sqrt(1 - z * z);
      const Eigen::Vector3d ray(r * std::cos(angle), r * std::sin(angle), z);
      const Hit hit = Trace(Eigen::Vector3d::Zero(), ray);
      cloud.points_m[i] = (hit.distance_m * ray).cast<float>(), surfaces[i] = hit.surface;
    });
    return cloud;
  }

  // A turning lidar of 32 rings 1.33 degrees apart, 2250 beams each, from the origin; ranges with 2 cm of noise.
  [[nodiscard]] Cloud ScanRings(unsigned seed, std::vector<int>& surfaces) const {
    constexpr int kRings = 32, kSteps = 2250;
    constexpr double kLowest_deg = -30.67, kStep_deg = 4.0 / 3, kSigma_m = 0.02;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Cloud cloud;
    for (int step = 0; step < kSteps; ++step)
      for (int ring = 0; ring < kRings; ++ring) {
        const double up = (kLowest_deg + kStep_deg * ring) * M_PI / 180, round = 2 * M_PI * step / kSteps;
        const Eigen::Vector3d ray(std::cos(up) * std::cos(round), std::cos(up) * std::sin(round), std::sin(up));
        const Hit hit = Trace(Eigen::Vector3d::Zero(), ray);
        cloud.points_m.push_back(((hit.distance_m + kSigma_m * normal(random)) * ray).cast<float>());
        surfaces.push_back(hit.surface);
      }
    return cloud;
  }

  // What a pinhole camera without distortion takes, times `gain`.
  [[nodiscard]] Picture Take(const CloudCamera& camera, int width_px, int height_px, double gain) const {
    Picture picture{
        width_px, height_px,
        std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px))};
    const Se3 T_lidar_cam = camera.T_cam_lidar.Inverse();
    const Eigen::Matrix3d R = T_lidar_cam.R();
    ParallelFor(static_cast<std::size_t>(height_px), [&](std::size_t y) {
      std::uint8_t* out = &picture.rgb[3 * y * static_cast<std::size_t>(width_px)];
      for (int x = 0; x < width_px; ++x) {
        const CameraIntrinsics& k = camera.intrinsics;
        const Eigen::Vector3d ray((x - k.cx_px) / k.fx_px, (static_cast<double>(y) - k.cy_px) / k.fy_px, 1);
        for (const std::uint8_t c : ColourOf(Trace(T_lidar_cam.p_m, R * ray).surface))
          *out++ = static_cast<std::uint8_t>(std::min(255.0, std::round(gain * c)));
      }
    });
    return picture;
  }
};

// A camera at `p_m` that looks along (cos yaw, sin yaw, 0), upright, with the principal point in the middle.
inline CloudCamera RoomCamera(const Eigen::Vector3d& p_m, double yaw_rad, int width_px, int height_px,
                              double focal_px) {
  CloudCamera camera;
  camera.intrinsics.fx_px = camera.intrinsics.fy_px = focal_px;
  camera.intrinsics.cx_px = 0.5 * (width_px - 1), camera.intrinsics.cy_px = 0.5 * (height_px - 1);
  Eigen::Matrix4d T_lidar_cam = Eigen::Matrix4d::Identity();
  T_lidar_cam.block<3, 1>(0, 0) << std::sin(yaw_rad), -std::cos(yaw_rad), 0;
  T_lidar_cam.block<3, 1>(0, 1) << 0, 0, -1;
  T_lidar_cam.block<3, 1>(0, 2) << std::cos(yaw_rad), std::sin(yaw_rad), 0;
  T_lidar_cam.block<3, 1>(0, 3) = p_m;
  camera.T_cam_lidar = Se3::FromMatrix(T_lidar_cam).Inverse();
  return camera;
}

}  // namespace rigcal::cloud
