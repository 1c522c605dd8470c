// A virtual robot and the room it stands in. World: x to the front, y to the left, z up, origin in the middle of the
// floor. Body: the robot's own frame, axes alike.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "client/sim/rig/bend.h"
#include "client/sim/rig/lens_misfit.h"
#include "server/math/se3.h"
#include "server/model/sessions/session.h"

namespace rigcal::sim {

using Colour = Eigen::Vector3d;  // red, green, blue, 0 to 1

struct Box {
  Eigen::Vector3d centre_m, size_m;
  double yaw_rad = 0.0;
  Colour colour = Colour::Constant(0.5);
};

struct Room {
  Eigen::Vector3d size_m{7, 7, 4};
  std::vector<Box> boxes;
  int patches_per_wall = 0;  // of colour
};

// A checkerboard on a plate. Plate frame: middle of the plate, axes as the board's (x along columns, y along rows, z
// into the plate).
struct RigBoard {
  Target target;
  Se3 T_world_plate;
  Bend bend = {};
  double stretch_ratio = 1.0;  // of what is printed along its columns, about the plate's middle

  [[nodiscard]] Se3 T_world_board() const;  // of the board's frame, server/model/sensors/target.h
};

struct CameraTruth {
  CameraIntrinsics intrinsics;
  int width_px = 0, height_px = 0;
  double blur_px = 0.7;                  // standard deviation of the point spread
  double noise_grey = 2.0;               // of one pixel, in 1/255
  double vignetting_ratio = 0.3;         // of the natural fall of light (fourth power of the cosine)
  double corner_sigma_px = 0.05;         // what finding a corner is expected to add: for feature level and the bound
  std::vector<double> intrinsics_sigma;  // of a calibration beforehand: fx fy cx cy and the distortion
  LensMisfit misfit = {};                // beyond the intrinsics
  // The entrance pupil lies 2 sin(angle)^2 of this towards what is seen at an angle to the axis, this at 45 degrees:
  // rays do not meet in one point, and what is near is seen elsewhere than what is far.
  double pupil_shift_m = 0.0;
  bool pupil_by_tangent = false;  // tan(angle)^2 instead: another law, the same at 45 degrees
};

struct LidarTruth {
  std::vector<double> elevations_rad;  // one per beam, from the lowest: ring 0
  int firings_per_turn = 2170;
  double range_sigma_m = 0.02, range_min_m = 0.5, range_max_m = 80.0;
  double mixed_pixels_ratio = 0.0, incidence_bias_m = 0.0;  // see Disturbances
};

struct TrackerTruth {
  double sigma_m = 2e-4, sigma_rad = 8.7e-4;  // per axis
};

struct RigSensor {
  SensorId id;
  SensorKind kind = SensorKind::kCamera;
  std::optional<TargetId> sees;
  Se3 T_body_sensor;
  CameraTruth camera;
  LidarTruth lidar;
  TrackerTruth tracker;
};

// How the robot is placed for the captures, about `start`.
struct MotionPlan {
  int captures = 40;
  Se3 T_world_body_start;
  Eigen::Vector3d position_range_m{0.2, 0.2, 0.03};  // plus or minus
  double yaw_range_rad = 0.2;                        // plus or minus
  double tilt_rms_rad = 0.087;                       // of the angle between the body's z and the vertical
};

struct Rig {
  std::string name;
  RobotId robot;
  SensorId reference;
  Room room;
  std::vector<RigBoard> boards;
  std::vector<RigSensor> sensors;
  std::vector<SensorPair> skip_pairs;
  MotionPlan motion;
  double nominal_sigma_m = 0.01, nominal_sigma_rad = 0.0175;  // of the drawing, per axis

  [[nodiscard]] const RigSensor& SensorOf(const SensorId& id) const;  // must exist
  [[nodiscard]] const RigBoard& BoardOf(const TargetId& id) const;    // must exist
};

// Sensors, boards, reference and pairs exist and fit each other. The error names what does not.
[[nodiscard]] Status Validate(const Rig& rig);

}  // namespace rigcal::sim
