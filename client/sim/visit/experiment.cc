#include "client/sim/visit/experiment.h"

#include <algorithm>
#include <cmath>

#include "client/sim/rig/lens.h"
#include "client/sim/rig/random.h"
#include "client/sim/visit/declared.h"
#include "client/sim/visit/disturb.h"
#include "client/sim/visit/mounts.h"
#include "client/sim/visit/placement.h"

namespace rigcal::sim {
namespace {

void Bump(Experiment& experiment) {
  experiment.bumped_from_idx = experiment.IndexAt(experiment.options.bump_at_ratio);
  if (!experiment.options.bump) return;
  const SensorId& id = *experiment.options.bump;
  Random random(KeyOf(experiment.options.seed, "bump", id.str()));
  Vector6d xi;
  xi << experiment.options.bump_m * random.Normals<3>().normalized(),
      experiment.options.bump_rad * random.Normals<3>().normalized();
  experiment.T_body_bumped[id] = (experiment.rig.SensorOf(id).T_body_sensor * Se3::Exp(xi)).Normalized();
}

void DrawBeamBiases(Experiment& experiment) {
  for (const RigSensor& sensor : experiment.rig.sensors) {
    if (sensor.kind != SensorKind::kLidar) continue;
    Random random(KeyOf(experiment.options.seed, "beam bias", sensor.id.str()));
    std::vector<double>& biases_m = experiment.beam_bias_m[sensor.id];
    for (std::size_t beam = 0; beam < sensor.lidar.elevations_rad.size(); ++beam)
      biases_m.push_back(experiment.options.lidar_bias_sigma_m * random.Normal());
  }
}

void ScaleAndSoil(const Options& options, Rig& rig) {
  for (RigBoard& board : rig.boards) board.target.square_m *= options.board_scale_ratio;
  for (RigSensor& sensor : rig.sensors) {
    CameraTruth& camera = sensor.camera;
    if (sensor.kind == SensorKind::kCamera) {
      camera.intrinsics = Scaled(camera.intrinsics, options.scale_ratio);
      camera.width_px = static_cast<int>(std::lround(camera.width_px * options.scale_ratio));
      camera.height_px = static_cast<int>(std::lround(camera.height_px * options.scale_ratio));
      for (std::size_t i = 0; i < std::min<std::size_t>(4, camera.intrinsics_sigma.size()); ++i)
        camera.intrinsics_sigma[i] *= options.scale_ratio;
    }
    for (double& sigma : camera.intrinsics_sigma) sigma *= options.noise_factor;
    for (double* sigma : {&camera.noise_grey, &camera.corner_sigma_px, &sensor.lidar.range_sigma_m,
                          &sensor.tracker.sigma_m, &sensor.tracker.sigma_rad})
      *sigma *= options.noise_factor;
  }
}

Status CheckOptions(const Rig& rig, const Options& options) {
  const auto refuse = [](const std::string& what, const std::string& cure) {
    return Fail(ErrorCode::kInvalidInput, what, cure);
  };
  if (options.bump && std::none_of(rig.sensors.begin(), rig.sensors.end(),
                                   [&](const RigSensor& sensor) { return sensor.id == *options.bump; }))
    return refuse("sensor " + options.bump->str() + " cannot be bumped: the rig has none of this name",
                  "Name one of the rig's sensors.");
  if (!(options.scale_ratio >= 0.05 && options.scale_ratio <= 2))
    return refuse("scale is out of range", "Give 0.05 to 2.");
  if (!(options.noise_factor >= 0 && options.noise_factor <= 1000))
    return refuse("noise is out of range", "Give 0 to 1000.");
  if (!(options.dropout_ratio >= 0 && options.dropout_ratio < 1))
    return refuse("dropouts is out of range", "Give 0 to 0.99.");
  if (!(options.board_scale_ratio > 0.5 && options.board_scale_ratio < 2))
    return refuse("board-scale is out of range", "Give 0.5 to 2; 1.001 is a board 0.1 % too large.");
  if (!(options.bump_at_ratio > 0 && options.bump_at_ratio < 1))
    return refuse("bump-at is out of range", "Give a ratio between 0 and 1; 0.25 is after the first quarter.");
  if (options.captures && (*options.captures < 1 || *options.captures > 10'000))
    return refuse("captures is out of range", "Give 1 to 10000.");
  return {};
}

}  // namespace

Se3 Experiment::T_body_sensor(const SensorId& id, std::size_t capture_idx) const {
  const auto bumped = T_body_bumped.find(id);
  const bool is_bumped = bumped != T_body_bumped.end() && capture_idx >= bumped_from_idx;
  const Se3 T_body_rest = is_bumped ? bumped->second : rig.SensorOf(id).T_body_sensor;
  const auto offsets = T_rest_sensor.find(id);
  return offsets == T_rest_sensor.end() ? T_body_rest : T_body_rest * offsets->second[capture_idx];
}

Se3 Experiment::T_world_sensor(const SensorId& id, std::size_t capture_idx) const {
  const bool is_elsewhere = wrong_instant && wrong_instant->sensor == id && wrong_instant->capture_idx == capture_idx;
  return (is_elsewhere ? wrong_instant->T_world_body : T_world_body[capture_idx]) * T_body_sensor(id, capture_idx);
}

RigBoard Experiment::BoardAt(const TargetId& id, std::size_t capture_idx) const {
  RigBoard board = rig.BoardOf(id);
  if (moved_board && moved_board->board == id && capture_idx >= moved_board->from_idx)
    board.T_world_plate = moved_board->T_world_plate;
  return board;
}

CameraTruth Experiment::CameraAt(const SensorId& id, std::size_t capture_idx) const {
  CameraTruth camera = rig.SensorOf(id).camera;
  if (!refocused || refocused->sensor != id || capture_idx < refocused->from_idx) return camera;
  camera.intrinsics.fx_px *= 1 + refocused->by_ratio;
  camera.intrinsics.fy_px *= 1 + refocused->by_ratio;
  return camera;
}

Eigen::Vector2d Experiment::ShiftOf(const SensorId& id, std::size_t capture_idx) const {
  const bool is_shifted = shifted && shifted->sensor == id && shifted->capture_idx == capture_idx;
  return is_shifted ? shifted->shift_px : Eigen::Vector2d::Zero();
}

std::size_t Experiment::BurstOf(std::size_t capture_idx) const {
  return capture_idx / static_cast<std::size_t>(options.disturb.burst);
}

std::size_t Experiment::IndexAt(double ratio) const {
  return static_cast<std::size_t>(ratio * static_cast<double>(captures.size()));
}

Se3 Experiment::T_ref_sensor(const SensorId& id) const {
  if (id == rig.reference) return {};
  return (rig.SensorOf(rig.reference).T_body_sensor.Inverse() * rig.SensorOf(id).T_body_sensor).Normalized();
}

bool Experiment::IsRecorded(const SensorId& id, std::size_t capture_idx) const {
  return Random(KeyOf(options.seed, "dropout", id.str(), capture_idx)).Uniform() >= options.dropout_ratio;
}

Result<Experiment> Prepare(Rig rig, const Options& options) {
  RIGCAL_TRY(Validate(rig));
  RIGCAL_TRY(CheckOptions(rig, options));
  RIGCAL_TRY(CheckDisturbances(rig, options));
  RIGCAL_TRY(CheckMounts(rig, options.disturb));
  RIGCAL_ASSIGN(const Stamp start, ParseIso(options.captured_at));
  Experiment experiment;
  experiment.options = options;
  experiment.rig = std::move(rig);
  const std::vector<RigBoard> boards_as_declared = experiment.rig.boards;
  ScaleAndSoil(options, experiment.rig);
  DisturbRig(options, experiment.rig);
  PlaceCaptures(experiment, start);
  Bump(experiment);
  LoosenMounts(experiment);
  DrawBeamBiases(experiment);
  RIGCAL_TRY(DisturbCaptures(experiment));
  experiment.declared = Declare(experiment, boards_as_declared, start);
  return experiment;
}

Scene SceneAt(const Experiment& experiment, std::size_t capture_idx) {
  Rig rig = experiment.rig;
  for (RigBoard& board : rig.boards) board = experiment.BoardAt(board.target.id, capture_idx);
  return SceneOf(rig);
}

}  // namespace rigcal::sim
