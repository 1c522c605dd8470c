#include "tests/unit/calib/virtual_room.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace rigcal::calib {
namespace {

using Eigen::Vector3d;

constexpr double kRangeMax_m = 100;

Panel Seen(const Panel& panel, const Se3& T_lidar_room) {
  return {T_lidar_room * panel.centre_m, T_lidar_room.R() * panel.u, T_lidar_room.R() * panel.v, panel.half_m};
}

void AddBox(const Vector3d& centre_m, const Vector3d& size_m, double turn_rad, std::vector<Panel>& room) {
  Se3 T_room_box;
  T_room_box.p_m = centre_m;
  T_room_box.q = Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ());
  for (const Panel& side : BoxAt(Vector3d::Zero(), size_m)) room.push_back(Seen(side, T_room_box));
}

// Floor in z = 0. A corridor has no ends.
std::vector<Panel> PanelsOf(RoomKind kind) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const double long_m = kind == RoomKind::kCorridor ? 400 : 9, wide_m = kind == RoomKind::kCorridor ? 4 : 7, high_m = 3;
  std::vector<Panel> room = {{0 * x, x, y, {long_m / 2, wide_m / 2}},
                             {high_m * z, x, y, {long_m / 2, wide_m / 2}},
                             {wide_m / 2 * y + high_m / 2 * z, x, z, {long_m / 2, high_m / 2}},
                             {-wide_m / 2 * y + high_m / 2 * z, x, z, {long_m / 2, high_m / 2}}};
  if (kind == RoomKind::kCorridor) return room;
  room.push_back({long_m / 2 * x + high_m / 2 * z, y, z, {wide_m / 2, high_m / 2}});
  room.push_back({-long_m / 2 * x + high_m / 2 * z, y, z, {wide_m / 2, high_m / 2}});
  AddBox({2.6, 1.9, 0.6}, {0.9, 1.3, 1.2}, 0.3, room);
  AddBox({-2.9, -1.6, 0.9}, {0.8, 1.1, 1.8}, -0.5, room);
  AddBox({-1.9, 2.4, 0.5}, {1.6, 0.9, 1.0}, 0.1, room);
  AddBox({1.8, -2.2, 0.7}, {1.2, 1.0, 1.4}, 0.8, room);
  return room;
}

// Sums of uniform numbers: the same on every standard library.
double Noise(std::mt19937& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
  return sum;
}

// Nearest hits with noise along the beams. No pixels that are mixed of two surfaces: Scan() looks for those on one side
// only, which turns every edge by the same small angle.
std::vector<Eigen::Vector3f> ScanFrom(const std::vector<Panel>& room, const Se3& T_room_lidar, const Beams& beams,
                                      unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Panel> seen;
  for (const Panel& panel : room) seen.push_back(Seen(panel, T_room_lidar.Inverse()));
  std::vector<Eigen::Vector3f> points_m;
  for (double azimuth = beams.from_deg; azimuth < beams.till_deg; azimuth += beams.step_deg)
    for (int ring = 0; ring < beams.rings; ++ring) {
      const double a = azimuth * M_PI / 180,
                   e = (beams.bottom_deg + (beams.top_deg - beams.bottom_deg) * ring / (beams.rings - 1)) * M_PI / 180;
      const Vector3d direction(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
      double range_m = kRangeMax_m;
      for (const Panel& panel : seen)
        if (const auto hit = panel.Hit(direction)) range_m = std::min(range_m, *hit);
      const double noise_m = beams.noise_m * Noise(random);
      if (range_m < kRangeMax_m) points_m.push_back((direction * (range_m + noise_m)).cast<float>());
    }
  return points_m;
}

}  // namespace

VirtualRoom::VirtualRoom() {
  T_a_b.p_m = {0.12, -0.25, -0.31};
  T_a_b.q = Eigen::AngleAxisd(0.3, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.9, Vector3d::UnitY()) *
            Eigen::AngleAxisd(0.1, Vector3d::UnitX());
  beams_a = {32, -30, 20, 0.5, -180, 180, 0.02};
  beams_b = {32, -30, 20, 0.5, -180, 180, 0.02};
}

LidarLidarProblem RecordedIn(const VirtualRoom& room, int captures, unsigned seed) {
  std::mt19937 random(seed);
  const std::vector<Panel> panels = PanelsOf(room.kind);
  LidarLidarProblem problem;
  problem.lidar_a.id = SensorId("horizontal");
  problem.lidar_b.id = SensorId("tilted");
  problem.lidar_a.kind = problem.lidar_b.kind = SensorKind::kLidar;
  Vector6d off;
  for (int i = 0; i < 6; ++i) off[i] = (i < 3 ? room.start_m : room.start_rad) * Noise(random);
  problem.T_a_b_nominal = room.T_a_b * Se3::Exp(off);
  for (int i = 0; i < captures; ++i) {
    const double x = 0.5 * Noise(random), y = 0.4 * Noise(random), turn = 2 * Noise(random);
    const double roll = 0.03 * Noise(random), pitch = 0.03 * Noise(random);
    Se3 T_room_a;
    T_room_a.p_m = {x, room.kind == RoomKind::kCorridor ? 0.3 * y : y, 1.3};
    T_room_a = T_room_a * Se3::Exp((Vector6d() << 0, 0, 0, 0, 0, turn).finished()) *
               Se3::Exp((Vector6d() << 0, 0, 0, roll, pitch, 0).finished());
    problem.captures.push_back({CaptureId(std::to_string(1000 + i).substr(1)),
                                ScanFrom(panels, T_room_a, room.beams_a, static_cast<unsigned>(random())),
                                ScanFrom(panels, T_room_a * room.T_a_b, room.beams_b, static_cast<unsigned>(random())),
                                {}});
  }
  return problem;
}

void SpoilBeams(double sigma_m, unsigned seed, LidarLidarProblem& problem) {
  std::mt19937 random(seed);
  for (std::vector<Eigen::Vector3f> LidarLidarCapture::*cloud : {&LidarLidarCapture::a_m, &LidarLidarCapture::b_m}) {
    std::map<long, double> bias_m;
    for (LidarLidarCapture& capture : problem.captures)
      for (Eigen::Vector3f& p : capture.*cloud) {
        const double elevation_deg = std::atan2(p.z(), std::hypot(p.x(), p.y())) * 180 / M_PI;
        const auto [bias, is_new] = bias_m.try_emplace(std::lround(20 * elevation_deg), 0.0);
        if (is_new) bias->second = sigma_m * Noise(random);
        p += static_cast<float>(bias->second) * p.normalized();
      }
  }
}

LidarLidarProblem Exchanged(const LidarLidarProblem& problem) {
  LidarLidarProblem other = problem;
  std::swap(other.lidar_a, other.lidar_b);
  other.T_a_b_nominal = problem.T_a_b_nominal->Inverse();
  for (LidarLidarCapture& capture : other.captures) std::swap(capture.a_m, capture.b_m);
  return other;
}

}  // namespace rigcal::calib
