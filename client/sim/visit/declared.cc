#include "client/sim/visit/declared.h"

#include <cmath>

#include "client/sim/rig/random.h"

namespace rigcal::sim {
namespace {

Target DeclaredTarget(const RigBoard& board, double board_scale_ratio) {
  Target target = board.target;
  target.square_sigma_m = target.square_m * std::abs(board_scale_ratio - 1);
  return target;
}

// A calibration beforehand that was off by what it says of itself.
CameraIntrinsics Calibrated(const CameraTruth& camera, Random& random) {
  CameraIntrinsics given = camera.intrinsics;
  double* const parts[] = {&given.fx_px, &given.fy_px, &given.cx_px, &given.cy_px};
  for (std::size_t i = 0; i < camera.intrinsics_sigma.size(); ++i) {
    double& value = i < 4 ? *parts[i] : given.distortion[i - 4];
    value += camera.intrinsics_sigma[i] * random.Normal();
  }
  return given;
}

void DeclareLens(const Experiment& experiment, const RigSensor& sensor, Sensor& declared) {
  declared.camera_model = sensor.camera.intrinsics.model;
  if (experiment.options.intrinsics == IntrinsicsKind::kExact) declared.intrinsics = sensor.camera.intrinsics;
  if (experiment.options.intrinsics != IntrinsicsKind::kCalibrated) return;
  Random random(KeyOf(experiment.options.seed, "intrinsics", sensor.id.str()));
  declared.intrinsics = Calibrated(sensor.camera, random);
  declared.intrinsics_sigma = sensor.camera.intrinsics_sigma;
}

Se3 Nominal(const Experiment& experiment, const SensorId& id) {
  Random random(KeyOf(experiment.options.seed, "nominal", id.str()));
  Vector6d xi;
  xi << experiment.rig.nominal_sigma_m * random.Normals<3>(), experiment.rig.nominal_sigma_rad * random.Normals<3>();
  return (experiment.T_ref_sensor(id) * Se3::Exp(xi)).Normalized();
}

Sensor DeclaredSensor(const Experiment& experiment, const RigSensor& sensor) {
  Sensor declared;
  declared.id = sensor.id;
  declared.kind = sensor.kind;
  declared.sees = sensor.sees;
  if (sensor.kind == SensorKind::kCamera) DeclareLens(experiment, sensor, declared);
  if (sensor.kind == SensorKind::kLidar && experiment.options.lidar_bias_sigma_m > 0)
    declared.range_bias_sigma_m = experiment.options.lidar_bias_sigma_m;
  if (sensor.id != experiment.rig.reference) declared.T_ref_nominal = Nominal(experiment, sensor.id);
  return declared;
}

}  // namespace

SessionHeader Declare(const Experiment& experiment, const std::vector<RigBoard>& boards, Stamp start) {
  SessionHeader header;
  header.robot = experiment.rig.robot;
  header.rig_model = experiment.rig.name;
  header.captured_at = start;
  header.operator_name = "rigcal simulate";
  header.reference = experiment.rig.reference;
  for (const RigBoard& board : boards)
    header.targets.push_back(DeclaredTarget(board, experiment.options.board_scale_ratio));
  for (const RigSensor& sensor : experiment.rig.sensors) header.sensors.push_back(DeclaredSensor(experiment, sensor));
  header.conditions = {{"simulated", "seed " + std::to_string(experiment.options.seed)}};
  return header;
}

}  // namespace rigcal::sim
