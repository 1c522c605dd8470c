// A calibration whose every number is at one place only, and the rotation of its sensors written out by hand: readers
// of the files are held against this, and not against the product's own mathematics.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <string>

#include "server/formats/export/formats.h"

namespace rigcal::exports::sample {

// p_root = R p + t.
struct Placed {
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return R * p + t; }
  [[nodiscard]] Eigen::Vector3d Back(const Eigen::Vector3d& p) const { return R.transpose() * (p - t); }
};

inline Eigen::Matrix3d Rows(double a, double b, double c, double d, double e, double f, double g, double h, double i) {
  Eigen::Matrix3d R;
  R << a, b, c, d, e, f, g, h, i;
  return R;
}

inline const double kHalfRoot = std::sqrt(0.5);

// left: the root. right: turned by 0.6, 0.8 about y. lidar: exactly half a turn about z. mast: exactly half a turn
// about (1, 0, 1), where no Euler angle is zero. nose: pitched by exactly 90 degrees, where roll and yaw are one.
inline const std::map<std::string, Placed>& Truth() {
  static const std::map<std::string, Placed> truth = {
      {"left", {Rows(1, 0, 0, 0, 1, 0, 0, 0, 1), {0, 0, 0}}},
      {"right", {Rows(0.8, 0, 0.6, 0, 1, 0, -0.6, 0, 0.8), {0.25, -0.01, 0.02}}},
      {"lidar", {Rows(-1, 0, 0, 0, -1, 0, 0, 0, 1), {-1.5, 0.75, 0.125}}},
      {"mast", {Rows(0, 0, 1, 0, -1, 0, 1, 0, 0), {0.5, 0.0, 2.0}}},
      {"nose", {Rows(0, 0, 1, 0, 1, 0, -1, 0, 0), {1e-5, -3.0, 0.1}}}};
  return truth;
}

inline Eigen::Quaterniond QuaternionOf(const std::string& name) {  // w x y z
  if (name == "right") return {std::sqrt(0.9), 0, std::sqrt(0.1), 0};
  if (name == "lidar") return {0, 0, 0, 1};
  if (name == "mast") return {0, kHalfRoot, 0, kHalfRoot};
  if (name == "nose") return {kHalfRoot, 0, kHalfRoot, 0};
  return Eigen::Quaterniond::Identity();
}

inline CameraFit Camera(const std::string& name, CameraModel model, std::vector<double> distortion) {
  CameraFit fit;
  fit.camera = SensorId(name);
  fit.width_px = 640, fit.height_px = 480;
  fit.source = IntrinsicsSource::kEstimated;
  fit.intrinsics = {500.5, 510.25, 320.125, 239.75, std::move(distortion), model};
  return fit;
}

inline ExportedSensor Sensor(const std::string& name, std::optional<SensorKind> kind, double sigma) {
  ExportedSensor sensor{SensorId(name), name, kind, {}};
  sensor.T_root_sensor.p_m = Truth().at(name).t;
  sensor.T_root_sensor.q = QuaternionOf(name);
  for (int axis = 0; axis < 6; ++axis) sensor.covariance(axis, axis) = sigma * sigma * (axis + 1);
  return sensor;
}

inline Calibration Rig() {
  Calibration rig;
  rig.robot = RobotId("mapper-01");
  rig.revision = 3;
  rig.standing = "in use";
  rig.root = SensorId("left");
  rig.sensors = {Sensor("left", SensorKind::kCamera, 0), Sensor("right", SensorKind::kCamera, 0.001),
                 Sensor("lidar", SensorKind::kLidar, 0.002), Sensor("mast", SensorKind::kTracker, 0.003),
                 Sensor("nose", {}, 0.004)};
  rig.sensors[0].camera = Camera("left", CameraModel::kPinholeRadtan, {-0.25, 0.0625, 0.001, -0.002, 0.0});
  rig.sensors[1].camera = Camera("right", CameraModel::kFisheyeKb4, {0.03, -0.004, 0.0005, 0.00001});
  rig.left_out = {"tail: the height was not measured"};
  return rig;
}

inline std::string TextOf(Writer writer, const Calibration& rig = Rig()) {
  const auto written = writer(rig);
  if (!written) return "error: " + written.error().what;
  return written->files.front().text;
}

// A few points off all axes.
inline const std::vector<Eigen::Vector3d>& Points() {
  static const std::vector<Eigen::Vector3d> points = {{1, 2, 3}, {-0.5, 0.25, 7}, {0, 0, 1}};
  return points;
}

}  // namespace rigcal::exports::sample
