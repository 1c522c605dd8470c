// Colours a synthetic room: 1 M points, 7 cameras of 5 MP around the lidar, plates before the walls. Prints one JSON
// object. With a folder as argument it also writes the pictures and files there.
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "server/cloud/blend.h"
#include "server/cloud/overlay.h"
#include "server/cloud/point_files.h"
#include "server/cloud/render.h"
#include "tests/bench/sensors/cloud_room.h"

namespace rigcal::cloud {
namespace {

constexpr int kWidth_px = 2448, kHeight_px = 2048, kCameras = 7, kRuns = 9;
constexpr std::size_t kPoints = 1'000'000;

struct Scene {
  CloudRoom room;
  Cloud cloud;
  std::vector<int> surfaces;
  std::vector<CloudCamera> cameras;
  std::vector<Picture> pictures;
};

// Plates ahead, to the left, behind and to the right, so far from the lidar.
Scene PlatesAndCameras(double long_way_m, double short_way_m) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    const double yaw = M_PI / 2 * i + 0.3;
    const Eigen::Vector3d ahead(std::cos(yaw), std::sin(yaw), 0), side(-std::sin(yaw), std::cos(yaw), 0);
    scene.room.plates.push_back({(i % 2 == 0 ? long_way_m : short_way_m) * ahead + Eigen::Vector3d(0, 0, 0.1),
                                 0.4 * side,
                                 {0, 0, 0.3},
                                 {250, 250, static_cast<std::uint8_t>(40 * i)}});
  }
  for (int i = 0; i < kCameras; ++i) {
    const double yaw = 2 * M_PI * i / kCameras;
    const Eigen::Vector3d place(0.25 * std::cos(yaw), 0.25 * std::sin(yaw), -0.2);
    scene.cameras.push_back(RoomCamera(place, yaw, kWidth_px, kHeight_px, 1900));
    scene.pictures.push_back(scene.room.Take(scene.cameras.back(), kWidth_px, kHeight_px, 1 - 0.05 * (i % 3)));
  }
  return scene;
}

Scene Dense() {
  Scene scene = PlatesAndCameras(1.8, 1.8);
  scene.cloud = scene.room.Scan(kPoints, scene.surfaces);
  return scene;
}

// The walls are 0.9 m behind the plates: two rings of a lidar fit a slope from one to the other.
Scene Rings() {
  Scene scene = PlatesAndCameras(3.2, 2.2);
  scene.cloud = scene.room.ScanRings(1, scene.surfaces);
  return scene;
}

struct Coloured {
  std::vector<CameraView> views;
  ColouredCloud cloud;
};

Coloured Colour(const Scene& scene) {
  Coloured result;
  Beams beams = BeamsOf(scene.cloud);
  for (std::size_t i = 0; i < scene.cameras.size(); ++i)
    result.views.push_back(See(beams, scene.cameras[i], scene.pictures[i]));
  result.cloud = Blend(std::move(beams), result.views);
  return result;
}

double Processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Times {
  double best_ms = 0, median_ms = 0, processor_ms = 0;  // the latter of all threads together
};
Times TimesOf(const Scene& scene) {
  std::vector<double> times_ms;
  const double before_ms = Processor_ms();
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    const Coloured coloured = Colour(scene);
    times_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times_ms.begin(), times_ms.end());
  return {times_ms[0], times_ms[kRuns / 2], (Processor_ms() - before_ms) / kRuns};
}

// Which surface's colour it is, whatever the exposure: the hue's nearest.
bool IsColourOf(const CloudRoom& room, int surface, const Rgb& rgb) {
  const auto unit = [](const Rgb& c) { return Eigen::Vector3d(c[0], c[1], c[2]).normalized(); };
  return (unit(room.ColourOf(surface)) - unit(rgb)).norm() < 0.06;
}

constexpr double kBehind_m = 0.2;  // beyond noise
// Whether a plate lies before the point, seen from the camera.
bool PlateBefore(const Scene& scene, const CloudCamera& camera, const Eigen::Vector3f& point_m) {
  const Eigen::Vector3d from = camera.T_cam_lidar.Inverse().p_m, ray = point_m.cast<double>() - from;
  const CloudRoom::Hit hit = scene.room.Trace(from, ray);
  return hit.surface >= CloudRoom::kWallColours && (1 - hit.distance_m) * ray.norm() > kBehind_m;
}

// Whether a camera's ray to the point meets nothing else.
bool InSight(const Scene& scene, const Eigen::Vector3f& point_m) {
  return std::any_of(scene.cameras.begin(), scene.cameras.end(), [&](const CloudCamera& camera) {
    const Eigen::Vector3d p_cam = camera.T_cam_lidar * Eigen::Vector3d(point_m.cast<double>());
    const double u = camera.intrinsics.fx_px * p_cam.x() / p_cam.z() + camera.intrinsics.cx_px;
    const double v = camera.intrinsics.fy_px * p_cam.y() / p_cam.z() + camera.intrinsics.cy_px;
    if (!(p_cam.z() > 0) || u < 0 || v < 0 || u > kWidth_px - 1 || v > kHeight_px - 1) return false;
    const Eigen::Vector3d from = camera.T_cam_lidar.Inverse().p_m;
    return scene.room.Trace(from, point_m.cast<double>() - from).distance_m > 0.96;
  });
}

struct Judgement {
  std::size_t painted_as_plate = 0, plate_missed = 0, plate = 0;
  std::size_t hidden_painted = 0, in_sight = 0, missed = 0;
};
// Wall points that carry a plate's colour, and plate points in a picture that carry none.
Judgement Judge(const Scene& scene, const ColouredCloud& cloud) {
  Judgement judgement;
  for (std::size_t i = 0; i < cloud.rgb.size(); ++i) {
    const bool on_plate = scene.surfaces[i] >= CloudRoom::kWallColours, covered = cloud.camera_idx[i] != kNoCamera;
    judgement.plate += on_plate ? 1 : 0;
    judgement.plate_missed += on_plate && !covered ? 1 : 0;
    const bool painted_through = covered && PlateBefore(scene, scene.cameras[cloud.camera_idx[i]], cloud.points_m[i]);
    judgement.hidden_painted += painted_through ? 1 : 0;
    const bool in_sight = InSight(scene, cloud.points_m[i]);
    judgement.in_sight += in_sight ? 1 : 0;
    judgement.missed += in_sight && !covered ? 1 : 0;
    bool plate_colour = false;
    for (int s = 0; s < static_cast<int>(scene.room.plates.size()) && covered && !on_plate; ++s)
      plate_colour |= IsColourOf(scene.room, CloudRoom::kWallColours + s, cloud.rgb[i]);
    judgement.painted_as_plate += plate_colour && !IsColourOf(scene.room, scene.surfaces[i], cloud.rgb[i]) ? 1 : 0;
  }
  return judgement;
}

void Save(const std::filesystem::path& folder, const std::string& name, const std::string& bytes) {
  std::ofstream(folder / name, std::ios::binary) << bytes;
}

double SaveAll(const Scene& scene, const Coloured& coloured, const std::filesystem::path& folder) {
  const auto start = std::chrono::steady_clock::now();
  Save(folder, "front.png", RenderPng(coloured.cloud, {}, Angle::kFront));
  Save(folder, "top.png", RenderPng(coloured.cloud, {}, Angle::kTop));
  Save(folder, "oblique.png", RenderPng(coloured.cloud, {}, Angle::kOblique));
  Save(folder, "cloud.ply", WritePly(coloured.cloud));
  Save(folder, "points.bin", WriteViewerPoints(coloured.cloud));
  Save(folder, "overlay.jpg", OverlayOf(scene.pictures[0], coloured.views[0]).points_jpg);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

std::string Bytes(const Scene& scene, std::size_t threads) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  return WritePly(Colour(scene).cloud);
}

int Run(int argc, char** argv) {
  const Scene scene = Dense(), rings = Rings();
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  const Coloured coloured = Colour(scene);
  const Judgement judgement = Judge(scene, coloured.cloud), of_rings = Judge(rings, Colour(rings).cloud);
  const double files_ms = argc > 1 ? SaveAll(scene, coloured, argv[1]) : 0;
  const Times times = TimesOf(scene);
  const bool same = Bytes(scene, 1) == Bytes(scene, 2);
  std::printf(
      "{\"best_ms\": %.1f, \"colour_ms\": %.1f, \"processor_ms\": %.1f, \"files_ms\": %.0f, \"same_bytes\": %s, "
      "\"covered_ratio\": %.4f, "
      "\"painted_as_plate\": %zu, \"plate_points\": %zu, \"plate_missed\": %zu, \"rings_hidden_painted\": %zu, "
      "\"rings_plate_points\": %zu, \"rings_plate_missed\": %zu, \"rings_in_sight\": %zu, \"rings_missed\": %zu, "
      "\"hidden_painted\": %zu, \"missed\": %zu, \"azimuth_step_deg\": %.3f, "
      "\"elevation_step_deg\": %.3f}\n",
      times.best_ms, times.median_ms, times.processor_ms, files_ms, same ? "true" : "false",
      static_cast<double>(coloured.cloud.covered) / static_cast<double>(kPoints), judgement.painted_as_plate,
      judgement.plate, judgement.plate_missed, of_rings.hidden_painted, of_rings.plate, of_rings.plate_missed,
      of_rings.in_sight, of_rings.missed, judgement.hidden_painted, judgement.missed,
      BeamsOf(scene.cloud).azimuth_step_rad * 180 / M_PI, BeamsOf(scene.cloud).elevation_step_rad * 180 / M_PI);
  return 0;
}

}  // namespace
}  // namespace rigcal::cloud

int main(int argc, char** argv) { return rigcal::cloud::Run(argc, argv); }
