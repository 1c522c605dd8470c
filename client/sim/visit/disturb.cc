#include "client/sim/visit/disturb.h"

#include <algorithm>
#include <cmath>

#include "client/sim/visit/observe.h"
#include "client/sim/visit/placement.h"

namespace rigcal::sim {
namespace {

constexpr int kInstantsTried = 50;

tl::unexpected<Error> RefuseDisturbance(const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, what, cure);
}

bool SeesItsBoard(const Experiment& experiment, const RigSensor& camera, std::size_t capture_idx) {
  return TrueCorners(experiment, SceneAt(experiment, capture_idx), camera, capture_idx).has_value();
}

struct ChosenFile {
  const RigSensor* sensor;
  std::size_t capture_idx;
};

std::vector<ChosenFile> PicturesOfBoards(const Experiment& experiment) {
  std::vector<ChosenFile> pictures;
  for (const RigSensor& sensor : experiment.rig.sensors)
    for (std::size_t k = 0; k < experiment.captures.size(); ++k)
      if (sensor.kind == SensorKind::kCamera && experiment.IsRecorded(sensor.id, k) &&
          SeesItsBoard(experiment, sensor, k))
        pictures.push_back({&sensor, k});
  return pictures;
}

// The named one, else one of those that show a board.
Result<ChosenFile> Choose(const Experiment& experiment, const std::optional<Recording>& named, const char* purpose) {
  if (named) {
    const auto at = std::find(experiment.captures.begin(), experiment.captures.end(), named->capture);
    if (at == experiment.captures.end())
      return RefuseDisturbance(
          "capture " + named->capture.str() + " is none of this visit",
          "Name one of " + experiment.captures.front().str() + " to " + experiment.captures.back().str() + ".");
    return ChosenFile{&experiment.rig.SensorOf(named->sensor),
                      static_cast<std::size_t>(at - experiment.captures.begin())};
  }
  const std::vector<ChosenFile> pictures = PicturesOfBoards(experiment);
  if (pictures.empty())
    return RefuseDisturbance("no camera sees a board whole, so that no picture can be disturbed",
                             "Take more captures, or name one.");
  const double u = Random(KeyOf(experiment.options.seed, purpose)).Uniform();
  return pictures[static_cast<std::size_t>(u * static_cast<double>(pictures.size()))];
}

void MoveBoard(Experiment& experiment) {
  if (!experiment.options.disturb.board_move) return;
  const BoardMove& move = *experiment.options.disturb.board_move;
  Random random(KeyOf(experiment.options.seed, "board move"));
  const auto& boards = experiment.rig.boards;
  const auto drawn = static_cast<std::size_t>(random.Uniform() * static_cast<double>(boards.size()));
  const RigBoard& board = move.board ? experiment.rig.BoardOf(*move.board) : boards[drawn];
  experiment.moved_board = {board.target.id, (board.T_world_plate * Se3::Exp(AnyWay(move.by, random))).Normalized(),
                            experiment.IndexAt(move.at_ratio)};
}

Status TakeAtWrongInstant(Experiment& experiment) {
  if (!experiment.options.disturb.wrong_instant) return {};
  const auto& named = experiment.options.disturb.wrong_instant->of;
  RIGCAL_ASSIGN(const ChosenFile at, Choose(experiment, named, "wrong instant"));
  // A picture that no longer shows the board would hurt nobody.
  for (std::uint64_t i = 0; i < kInstantsTried; ++i) {
    const Se3 T_world_body = DrawBodyPose(experiment, KeyOf(experiment.options.seed, "other instant", {}, i));
    experiment.wrong_instant = {at.sensor->id, at.capture_idx, T_world_body};
    if (at.sensor->kind != SensorKind::kCamera || SeesItsBoard(experiment, *at.sensor, at.capture_idx)) break;
  }
  return {};
}

Status ShiftCapture(Experiment& experiment) {
  if (!experiment.options.disturb.capture_shift) return {};
  const CaptureShift& shift = *experiment.options.disturb.capture_shift;
  RIGCAL_ASSIGN(const ChosenFile at, Choose(experiment, shift.of, "shifted capture"));
  const double angle = Random(KeyOf(experiment.options.seed, "shift")).Uniform(0, 2 * M_PI);
  experiment.shifted = {at.sensor->id, at.capture_idx, shift.px * Eigen::Vector2d(std::cos(angle), std::sin(angle))};
  return {};
}

void RefocusCamera(Experiment& experiment) {
  if (!experiment.options.disturb.refocus) return;
  const Refocus& refocus = *experiment.options.disturb.refocus;
  std::vector<SensorId> cameras;
  for (const RigSensor& sensor : experiment.rig.sensors)
    if (sensor.kind == SensorKind::kCamera) cameras.push_back(sensor.id);
  const double u = Random(KeyOf(experiment.options.seed, "refocus")).Uniform();
  const SensorId& drawn = cameras[static_cast<std::size_t>(u * static_cast<double>(cameras.size()))];
  experiment.refocused = {refocus.camera.value_or(drawn), experiment.IndexAt(refocus.at_ratio), refocus.by_ratio};
}

Status CheckRefocus(const Rig& rig, const Refocus& refocus) {
  if (!(refocus.at_ratio > 0 && refocus.at_ratio < 1 && std::abs(refocus.by_ratio) <= 0.5))
    return RefuseDisturbance("refocus is out of range", "Give -0.5 to 0.5, at a ratio between 0 and 1.");
  const auto is_it = [&](const RigSensor& sensor) {
    return sensor.kind == SensorKind::kCamera && (!refocus.camera || sensor.id == *refocus.camera);
  };
  if (std::none_of(rig.sensors.begin(), rig.sensors.end(), is_it))
    return RefuseDisturbance(
        "no lens can be refocused: the rig has no camera" + (refocus.camera ? " " + refocus.camera->str() : ""),
        "Name one of the rig's cameras.");
  return {};
}

Status CheckRecording(const Rig& rig, const std::optional<Recording>& of, bool is_picture) {
  if (!of) return {};
  const auto known = std::find_if(rig.sensors.begin(), rig.sensors.end(),
                                  [&](const RigSensor& sensor) { return sensor.id == of->sensor; });
  if (known == rig.sensors.end())
    return RefuseDisturbance("sensor " + of->sensor.str() + " cannot be disturbed: the rig has none of this name",
                             "Name one of the rig's sensors.");
  if (is_picture && known->kind != SensorKind::kCamera)
    return RefuseDisturbance("sensor " + of->sensor.str() + " takes no pictures that could be shifted",
                             "Name a camera.");
  return {};
}

Status CheckBoardMove(const Rig& rig, const BoardMove& move) {
  if (!(move.at_ratio > 0 && move.at_ratio < 1))
    return RefuseDisturbance("board-moved is out of range", "Give a ratio between 0 and 1.");
  if (!(move.by.m >= 0 && move.by.m <= 1 && move.by.rad >= 0 && move.by.rad <= M_PI))
    return RefuseDisturbance("board-moved is out of range", "Give 0 to 1 m and 0 to 180 degrees.");
  if (move.board && std::none_of(rig.boards.begin(), rig.boards.end(),
                                 [&](const RigBoard& board) { return board.target.id == *move.board; }))
    return RefuseDisturbance("board " + move.board->str() + " cannot be moved: the rig has none of this name",
                             "Name one of the rig's boards.");
  return {};
}

struct LimitedSize {
  const char* name;
  double value, max;
};

}  // namespace

Vector6d ScatterOf(const Displacement& sigma, Random& random) {
  Vector6d xi;
  xi << sigma.m * random.Normals<3>(), sigma.rad * random.Normals<3>();
  return xi;
}

Vector6d AnyWay(const Displacement& by, Random& random) {
  Vector6d xi;
  xi << by.m * random.Normals<3>().normalized(), by.rad * random.Normals<3>().normalized();
  return xi;
}

Status CheckDisturbances(const Rig& rig, const Options& options) {
  const Disturbances& disturb = options.disturb;
  for (const LimitedSize& range :
       {LimitedSize{"lens-misfit", disturb.lens_misfit_px, 50},
        LimitedSize{"shift-capture", disturb.capture_shift.value_or(CaptureShift{}).px, 500},
        LimitedSize{"visit-scatter", disturb.visit_scatter.m, 1},
        LimitedSize{"visit-scatter", disturb.visit_scatter.rad, 1},
        LimitedSize{"board-bend", disturb.board_bend_m, 0.1},
        LimitedSize{"board-stretch", disturb.board_stretch_ratio, 0.1},
        LimitedSize{"mixed-pixels", disturb.mixed_pixels_ratio, 1},
        LimitedSize{"incidence-bias", disturb.incidence_bias_m, 1}, LimitedSize{"sway", disturb.sway_per_s.m, 10},
        LimitedSize{"sway", disturb.sway_per_s.rad, 10}})
    if (!(range.value >= 0 && range.value <= range.max))
      return RefuseDisturbance(std::string(range.name) + " is out of range",
                               "Give 0 to " + std::to_string(range.max).substr(0, 5) + ".");
  if (!(std::abs(disturb.pose_clock_late_s) <= 1))
    return RefuseDisturbance("pose-clock-offset is out of range", "Give -1000 to 1000 ms.");
  if (disturb.burst < 1 || disturb.burst > 10'000)
    return RefuseDisturbance("bursts is out of range", "Give 1 to 10000.");
  if (disturb.board_move) RIGCAL_TRY(CheckBoardMove(rig, *disturb.board_move));
  if (disturb.refocus) RIGCAL_TRY(CheckRefocus(rig, *disturb.refocus));
  if (disturb.wrong_instant) RIGCAL_TRY(CheckRecording(rig, disturb.wrong_instant->of, false));
  if (disturb.capture_shift) RIGCAL_TRY(CheckRecording(rig, disturb.capture_shift->of, true));
  return {};
}

void DisturbRig(const Options& options, Rig& rig) {
  const Disturbances& disturb = options.disturb;
  const auto key = [&](const char* purpose, const std::string& name) { return KeyOf(options.seed, purpose, name); };
  for (RigBoard& board : rig.boards) {
    board.bend = DrawBend(disturb.board_bend_m, *board.target.plate_m, key("bend", board.target.id.str()));
    board.stretch_ratio = 1 + disturb.board_stretch_ratio;
  }
  for (RigSensor& sensor : rig.sensors) {
    CameraTruth& camera = sensor.camera;
    camera.pupil_shift_m = disturb.pupil_shift_m;
    camera.pupil_by_tangent = disturb.pupil_by_tangent;
    if (sensor.kind == SensorKind::kCamera)
      camera.misfit =
          DrawLensMisfit(disturb.lens_misfit_px, camera.width_px, camera.height_px, key("misfit", sensor.id.str()));
    sensor.lidar.mixed_pixels_ratio = disturb.mixed_pixels_ratio;
    sensor.lidar.incidence_bias_m = disturb.incidence_bias_m;
    if (disturb.visit_scatter.m == 0 && disturb.visit_scatter.rad == 0) continue;
    Random random(key("visit scatter", sensor.id.str()));
    sensor.T_body_sensor = (sensor.T_body_sensor * Se3::Exp(ScatterOf(disturb.visit_scatter, random))).Normalized();
  }
}

Status DisturbCaptures(Experiment& experiment) {
  MoveBoard(experiment);
  RefocusCamera(experiment);
  RIGCAL_TRY(TakeAtWrongInstant(experiment));
  return ShiftCapture(experiment);
}

}  // namespace rigcal::sim
