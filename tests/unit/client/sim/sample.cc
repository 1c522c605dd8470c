#include "tests/unit/client/sim/sample.h"

#include <gtest/gtest.h>

namespace rigcal::sim {

std::string SmallRigYaml() {
  return R"(format: 1
name: small
robot: small-01
reference: left
motion: {captures: 6, start_m: [0, 0, 1], position_range_m: [0.2, 0.2, 0.05], yaw_range_deg: 10, tilt_rms_deg: 6}
room:
  size_m: [6, 5, 3]
  boxes:
    crate: {centre_m: [-1.5, 0.4, 0.5], size_m: [0.5, 0.6, 1.0], yaw_deg: 20, colour: [0.2, 0.6, 0.3]}
boards:
  front: {inner_corners: [5, 4], square_size_m: 0.12, plate_size_m: [0.8, 0.7], T_world_plate: {p_m: [2.2, 0, 1], rpy_deg: [4, 12, 9]}}
  side: {inner_corners: [4, 3], square_size_m: 0.12, plate_size_m: [0.7, 0.6], T_world_plate: {p_m: [0.1, 1.9, 1], rpy_deg: [0, -8, 95]}}
camera: {size_px: [640, 480], corner_sigma_px: 0.1, intrinsics_sigma: [0.2, 0.2, 0.2, 0.2, 0.001, 0, 0, 0, 0]}
lidar: {elevations_deg: [-15, -12, -9, -6, -3, 0, 3, 6, 9], firings_per_turn: 900, range_sigma_m: 0.02}
tracker: {sigma_m: 0.0005, sigma_deg: 0.05}
sensors:
  left: {type: camera, sees: front, T_body_sensor: {p_m: [0.1, 0.1, 0], rpy_deg: [1, -1, 2]}, lens: {fx_px: 600, fy_px: 602, cx_px: 318, cy_px: 243, distortion: [-0.1, 0.02, 0.001, -0.001, 0]}}
  side: {type: camera, sees: side, T_body_sensor: {p_m: [0, 0.2, 0], rpy_deg: [0, 2, 92]}, lens: {fx_px: 598, fy_px: 597, cx_px: 322, cy_px: 238, distortion: [-0.08, 0.01, 0, 0.001, 0]}}
  top: {type: lidar, T_body_sensor: {p_m: [0, 0, 0.3], rpy_deg: [1, 2, 3]}}
  body: {type: tracker, T_body_sensor: {p_m: [-0.05, 0, 0.4], rpy_deg: [0, 0, 10]}}
skip_pairs: [[top, body]]
)";
}

Rig SmallRig() {
  auto rig = ReadRig(SmallRigYaml(), "small.yaml");
  EXPECT_TRUE(rig) << (rig ? "" : Sentence(rig.error()));
  return rig.value_or(Rig{});
}

Rig MarsMapper() {
  auto rig = LoadRig("mars-mapper");
  EXPECT_TRUE(rig) << (rig ? "" : Sentence(rig.error()));
  return rig.value_or(Rig{});
}

Experiment Prepared(const Rig& rig, const Options& options) {
  auto experiment = Prepare(rig, options);
  EXPECT_TRUE(experiment) << (experiment ? "" : Sentence(experiment.error()));
  return experiment.value_or(Experiment{});
}

}  // namespace rigcal::sim
