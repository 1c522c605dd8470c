#include "tests/bench/companion/held_board.h"

#include <cmath>
#include <sstream>

#include "client/sim/rig/rig_yaml.h"
#include "server/calib/camera/intrinsics.h"

namespace rigcal {
namespace {

constexpr double kRadPerDeg = 0.017453292519943295;

check::PictureSeen PictureOf(BoardView view) {
  check::PictureSeen picture{"", "", view.image_width_px, view.image_height_px, {}};
  const TargetId target = view.target;
  picture.seen[target].view = std::move(view);
  return picture;
}

std::optional<calib::joint::CameraViews> CameraViewsOf(const Sensor& camera, const Target& board,
                                                       const std::vector<std::pair<CaptureId, BoardView>>& views) {
  auto estimate = calib::EstimateCamera({camera, board, views});
  if (!estimate) return std::nullopt;
  return calib::joint::CameraViews{camera, board, views, *std::move(estimate)};
}

}  // namespace

std::string RingYaml(int cameras, double turn_deg, double apart_m) {
  std::ostringstream yaml;
  yaml << "format: 1\nname: ring\nrobot: ring\nreference: c0\nnominal_sigma_m: 0.01\nnominal_sigma_deg: 1\n"
          "motion: {captures: 60, start_m: [0, 0, 1], position_range_m: [0.2, 0.2, 0.1], yaw_range_deg: 10, "
          "tilt_rms_deg: 5}\n"
          "boards:\n  board: {inner_corners: [9, 6], square_size_m: 0.08, plate_size_m: [0.9, 0.7], "
          "T_world_plate: {p_m: [2.75, 0.1, 0.95], rpy_deg: [0, 0, 0]}}\n"
          "room: {size_m: [40, 40, 40], patches_per_wall: 8, boxes: {}}\n"
          "camera: {size_px: [640, 480], blur_px: 0.7, noise_grey: 2, vignetting_ratio: 0.35, corner_sigma_px: 0.2}\n"
          "sensors:\n";
  for (int i = 0; i < cameras; ++i) {
    const double yaw_rad = kRadPerDeg * turn_deg * i;
    yaml << "  c" << i << ": {type: camera, sees: board, T_body_sensor: {p_m: [" << 0.3 * std::cos(yaw_rad) << ", "
         << 0.3 * std::sin(yaw_rad) - apart_m * i << ", 0], rpy_deg: [0.3, 0.4, " << turn_deg * i
         << "]}, lens: {fx_px: 450, fy_px: 450, cx_px: 320, cy_px: 240, distortion: [-0.08, 0.07, 0.0003, -0.0002, "
            "-0.011]}, "
            "intrinsics_sigma: [0.1, 0.1, 0.1, 0.1, 0.0002, 0.0003, 0.00001, 0.00001, 0]}\n";
  }
  return yaml.str();
}

Result<HeldBoard> HeldBoard::Prepare(const std::string& rig_yaml, std::uint64_t seed, bool lenses_given,
                                     int captures_max) {
  RIGCAL_ASSIGN(sim::Rig rig, sim::ReadRig(rig_yaml, "ring"));
  sim::Options options;
  options.seed = seed;
  options.captures = captures_max;
  options.intrinsics = lenses_given ? sim::IntrinsicsKind::kCalibrated : sim::IntrinsicsKind::kAbsent;
  RIGCAL_ASSIGN(sim::Experiment experiment, sim::Prepare(std::move(rig), options));
  return HeldBoard(std::move(experiment));
}

void HeldBoard::PutRobot(std::size_t capture_idx, const SensorId& camera, const Se3& T_camera_board) {
  const Se3 T_body_camera = experiment_.rig.SensorOf(camera).T_body_sensor;
  const Se3 T_world_board = experiment_.rig.boards.front().T_world_board();
  experiment_.T_world_body[capture_idx] =
      (T_world_board * T_camera_board.Inverse() * T_body_camera.Inverse()).Normalized();
}

std::size_t HeldBoard::SeenBy(const SensorId& camera, const Se3& T_camera_board) {
  PutRobot(captures_, camera, T_camera_board);
  const sim::Scene scene = sim::SceneAt(experiment_, captures_);
  std::size_t seen = 0;
  for (const sim::RigSensor& sensor : experiment_.rig.sensors)
    if (sim::TrueCorners(experiment_, scene, sensor, captures_)) ++seen;
  return seen;
}

std::size_t HeldBoard::Hold(const SensorId& camera, const Se3& T_camera_board) {
  PutRobot(captures_, camera, T_camera_board);
  const sim::Scene scene = sim::SceneAt(experiment_, captures_);
  std::size_t seen = 0;
  for (const sim::RigSensor& sensor : experiment_.rig.sensors) {
    BoardView view = sim::ObserveBoard(experiment_, scene, sensor, captures_);
    seen += view.found ? 1 : 0;
    pictures_[sensor.id][experiment_.captures[captures_]] = PictureOf(std::move(view));
  }
  ++captures_;
  return seen;
}

std::vector<std::size_t> HeldBoard::SeeingIn(std::size_t capture) const {
  std::vector<std::size_t> seeing;
  const auto& sensors = experiment_.rig.sensors;
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const check::PictureSeen& picture = pictures_.at(sensors[s].id).at(experiment_.captures[capture]);
    if (picture.seen.at(Board().id).view.found) seeing.push_back(s);
  }
  return seeing;
}

companion::Captured HeldBoard::Captured() {
  companion::Captured captured;
  captured.header = experiment_.declared;
  captured.pictures = pictures_;
  for (const Sensor& sensor : captured.header.sensors) {
    captured.cameras[sensor.id] =
        companion::FindCameraSoFar(captured.header, sensor, captured.pictures[sensor.id], *lenses_);
    for (const auto& [capture, picture] : captured.pictures[sensor.id]) captured.files[sensor.id].insert(capture);
  }
  return captured;
}

std::optional<calib::joint::SessionViews> HeldBoard::ViewsOf(std::size_t captures) const {
  calib::joint::SessionViews views;
  views.reference = experiment_.declared.reference;
  views.targets = experiment_.declared.targets;
  for (const Sensor& sensor : experiment_.declared.sensors) {
    std::vector<std::pair<CaptureId, BoardView>> of_camera = check::ViewsOf(pictures_.at(sensor.id), Board().id);
    of_camera.resize(std::min(of_camera.size(), captures));
    auto camera = CameraViewsOf(sensor, Board(), of_camera);
    if (!camera) return std::nullopt;
    views.cameras.push_back(*std::move(camera));
    views.T_ref_sensor[sensor.id] = sensor.id == views.reference ? Se3{} : sensor.T_ref_nominal.value_or(Se3{});
  }
  return views;
}

}  // namespace rigcal
