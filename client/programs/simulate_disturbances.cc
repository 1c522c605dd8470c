#include "client/programs/simulate_disturbances.h"

#include <charconv>
#include <cmath>
#include <vector>

namespace rigcal::client {
namespace {

constexpr const char* kDrawn = "drawn";

// What stands before and after the first `mark`; the second is empty without it.
std::pair<std::string, std::string> SplitAt(const std::string& text, char mark) {
  const std::size_t at = text.find(mark);
  if (at == std::string::npos) return {text, ""};
  return {text.substr(0, at), text.substr(at + 1)};
}

std::optional<double> NumberIn(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

struct Example {
  const char* option;
  const char* form;  // how it is written
};

tl::unexpected<Error> NotRead(const Example& example, const std::string& text) {
  return Fail(ErrorCode::kInvalidInput, std::string(example.option) + " cannot be read from '" + text + "'",
              std::string("Write it as ") + example.form + ".");
}

// "LENGTH,DEG", the length in units of `unit_m`.
Result<sim::Displacement> ReadDisplacement(const Example& example, const std::string& text, double unit_m) {
  const auto [length, angle] = SplitAt(text, ',');
  const auto metres = NumberIn(length), degrees = NumberIn(angle);
  if (!metres || !degrees) return NotRead(example, text);
  return sim::Displacement{*metres * unit_m, *degrees * M_PI / 180};
}

Result<sim::Recording> ReadRecording(const Example& example, const std::string& text) {
  const auto [capture, sensor] = SplitAt(text, ':');
  const auto capture_id = CaptureId::Parse(capture);
  const auto sensor_id = SensorId::Parse(sensor);
  if (!capture_id || !sensor_id) return NotRead(example, text);
  return sim::Recording{*capture_id, *sensor_id};
}

// "M,DEG[@RATIO][:BOARD]"
Result<sim::BoardMove> ReadBoardMove(const std::string& text) {
  const Example example{"--board-moved", "M,DEG, M,DEG@RATIO or M,DEG@RATIO:BOARD: 0.005,0.5@0.25:front"};
  sim::BoardMove move;
  const auto [size, board] = SplitAt(text, ':');
  if (!board.empty()) {
    const auto id = TargetId::Parse(board);
    if (!id) return NotRead(example, text);
    move.board = *id;
  }
  const auto [by, at] = SplitAt(size, '@');
  RIGCAL_ASSIGN(move.by, ReadDisplacement(example, by, 1.0));
  if (at.empty()) return move;
  const auto ratio = NumberIn(at);
  if (!ratio) return NotRead(example, text);
  move.at_ratio = *ratio;
  return move;
}

// "PX[@CAPTURE:SENSOR]"
Result<sim::CaptureShift> ReadCaptureShift(const std::string& text) {
  const Example example{"--shift-capture", "PX or PX@CAPTURE:SENSOR: 8@07:front_right"};
  const auto [px, of] = SplitAt(text, '@');
  const auto size_px = NumberIn(px);
  if (!size_px) return NotRead(example, text);
  sim::CaptureShift shift{*size_px, {}};
  if (of.empty()) return shift;
  RIGCAL_ASSIGN(shift.of, ReadRecording(example, of));
  return shift;
}

// "RATIO[@AT][:CAMERA]"
Result<sim::Refocus> ReadRefocus(const std::string& text) {
  const Example example{"--refocus", "RATIO, RATIO@AT or RATIO@AT:CAMERA: 0.003@0.5:front_left"};
  sim::Refocus refocus;
  const auto [size, camera] = SplitAt(text, ':');
  if (!camera.empty()) {
    const auto id = SensorId::Parse(camera);
    if (!id) return NotRead(example, text);
    refocus.camera = *id;
  }
  const auto [by, at] = SplitAt(size, '@');
  const auto by_ratio = NumberIn(by), at_ratio = at.empty() ? std::optional(refocus.at_ratio) : NumberIn(at);
  if (!by_ratio || !at_ratio) return NotRead(example, text);
  refocus.by_ratio = *by_ratio;
  refocus.at_ratio = *at_ratio;
  return refocus;
}

// "SIZE[:SENSOR]"
struct SizeOfSensor {
  std::string size;
  std::optional<SensorId> sensor;
};
Result<SizeOfSensor> ReadSizeOfSensor(const Example& example, const std::string& text) {
  const auto [size, sensor] = SplitAt(text, ':');
  if (sensor.empty()) return SizeOfSensor{size, {}};
  const auto id = SensorId::Parse(sensor);
  if (!id) return NotRead(example, text);
  return SizeOfSensor{size, *id};
}

// "M,DEG[@FROM-UNTIL][:SENSOR]"
Result<sim::Excursion> ReadExcursion(const std::string& text) {
  const Example example{"--excursion", "M,DEG, M,DEG@FROM-UNTIL or M,DEG@FROM-UNTIL:SENSOR: 0.02,2@0.5-0.7:front_left"};
  sim::Excursion excursion;
  RIGCAL_ASSIGN(const SizeOfSensor of, ReadSizeOfSensor(example, text));
  excursion.sensor = of.sensor;
  const auto [by, during] = SplitAt(of.size, '@');
  RIGCAL_ASSIGN(excursion.by, ReadDisplacement(example, by, 1.0));
  if (during.empty()) return excursion;
  const auto [from, until] = SplitAt(during, '-');
  const auto from_ratio = NumberIn(from), until_ratio = NumberIn(until);
  if (!from_ratio || !until_ratio) return NotRead(example, text);
  excursion.from_ratio = *from_ratio;
  excursion.until_ratio = *until_ratio;
  return excursion;
}

Status ReadMounts(const DisturbanceWords& words, sim::Disturbances& disturb) {
  if (!words.excursion.empty()) {
    RIGCAL_ASSIGN(disturb.excursion, ReadExcursion(words.excursion));
  }
  if (!words.creep.empty()) {
    const Example example{"--creep", "M,DEG or M,DEG:SENSOR: 0.005,0.5:front_left"};
    RIGCAL_ASSIGN(const SizeOfSensor of, ReadSizeOfSensor(example, words.creep));
    RIGCAL_ASSIGN(const sim::Displacement by, ReadDisplacement(example, of.size, 1.0));
    disturb.creep = sim::Creep{by, of.sensor};
  }
  if (!words.rattle.empty()) {
    RIGCAL_ASSIGN(disturb.rattle, ReadDisplacement({"--rattle", "MM,DEG: 0.3,0.02"}, words.rattle, 1e-3));
  }
  if (!words.pose_drift.empty()) {
    RIGCAL_ASSIGN(disturb.pose_drift, ReadDisplacement({"--pose-drift", "MM,DEG: 1,0.02"}, words.pose_drift, 1e-3));
  }
  return {};
}

Result<sim::WrongInstant> ReadWrongInstant(const std::string& text) {
  sim::WrongInstant wrong;
  if (text == kDrawn) return wrong;
  RIGCAL_ASSIGN(wrong.of, ReadRecording({"--wrong-instant", "CAPTURE:SENSOR or drawn: 07:front_right"}, text));
  return wrong;
}

Status ReadBump(const DisturbanceWords& words, sim::Options& simulation) {
  if (!words.bump.empty()) simulation.bump = SensorId(words.bump);
  if (words.bump_by.empty()) return {};
  RIGCAL_ASSIGN(const sim::Displacement by, ReadDisplacement({"--bump-by", "M,DEG: 0.005,0.5"}, words.bump_by, 1.0));
  simulation.bump_m = by.m;
  simulation.bump_rad = by.rad;
  return {};
}

// A clock matters only where something moves: a body that is not said to stand still sways then.
constexpr const char* kUsualSway = "0.2,10";

Status ReadSway(const DisturbanceWords& words, sim::Disturbances& disturb) {
  disturb.pose_clock_late_s = words.pose_clock_offset_ms.value_or(0.0) * 1e-3;
  const std::string sway = words.sway.empty() && words.pose_clock_offset_ms ? kUsualSway : words.sway;
  if (sway.empty()) return {};
  RIGCAL_ASSIGN(disturb.sway_per_s, ReadDisplacement({"--sway", "M,DEG: 0.2,10"}, sway, 1.0));
  return {};
}

}  // namespace

Status ReadDisturbances(const DisturbanceWords& words, sim::Options& simulation) {
  sim::Disturbances& disturb = simulation.disturb;
  RIGCAL_TRY(ReadBump(words, simulation));
  if (!words.board_moved.empty()) {
    RIGCAL_ASSIGN(disturb.board_move, ReadBoardMove(words.board_moved));
  }
  if (!words.refocus.empty()) {
    RIGCAL_ASSIGN(disturb.refocus, ReadRefocus(words.refocus));
  }
  if (!words.shift_capture.empty()) {
    RIGCAL_ASSIGN(disturb.capture_shift, ReadCaptureShift(words.shift_capture));
  }
  if (!words.wrong_instant.empty()) {
    RIGCAL_ASSIGN(disturb.wrong_instant, ReadWrongInstant(words.wrong_instant));
  }
  RIGCAL_TRY(ReadMounts(words, disturb));
  RIGCAL_TRY(ReadSway(words, disturb));
  if (!words.visit_scatter.empty()) {
    RIGCAL_ASSIGN(disturb.visit_scatter,
                  ReadDisplacement({"--visit-scatter", "MM,DEG: 0.3,0.01"}, words.visit_scatter, 1e-3));
  }
  return {};
}

namespace {

void AddMounts(CLI::App& verb, DisturbanceWords& words, const std::string& group) {
  verb.add_option("--excursion", words.excursion,
                  "A sensor is elsewhere during a part of the captures (default 0.5-0.7), drawn unless named")
      ->type_name("M,DEG[@FROM-UNTIL][:SENSOR]")
      ->group(group);
  verb.add_option("--creep", words.creep, "A sensor's mount gives way from the first capture to the last")
      ->type_name("M,DEG[:SENSOR]")
      ->group(group);
  verb.add_option("--rattle", words.rattle, "Sigma per axis of every sensor on its mount, at each capture anew")
      ->type_name("MM,DEG")
      ->group(group);
  verb.add_option("--pose-drift", words.pose_drift, "Trackers drift: a random walk, sigma per axis and capture")
      ->type_name("MM,DEG")
      ->group(group);
}

}  // namespace

void AddDisturbances(CLI::App& verb, DisturbanceWords& words, sim::Options& simulation) {
  sim::Disturbances& disturb = simulation.disturb;
  // In brackets, as the manual page reads groups.
  const std::string group = "[What calibration takes for granted, broken]";
  verb.add_option("--bump", words.bump, "A sensor that is moved during the visit")->type_name("SENSOR")->group(group);
  verb.add_option("--bump-by", words.bump_by, "How far (default 0.005,0.5); the direction is drawn")
      ->type_name("M,DEG")
      ->group(group);
  verb.add_option("--bump-at", simulation.bump_at_ratio, "After which part of the captures (default 0.5)")
      ->type_name("RATIO")
      ->group(group);
  verb.add_option("--board-moved", words.board_moved, "A board that is moved during the visit, drawn unless named")
      ->type_name("M,DEG[@RATIO][:BOARD]")
      ->group(group);
  verb.add_option("--wrong-instant", words.wrong_instant,
                  "What a sensor tells of a capture is of another instant; drawn: some camera's picture")
      ->type_name("CAPTURE:SENSOR|drawn")
      ->group(group);
  verb.add_option("--shift-capture", words.shift_capture, "One picture is shifted, drawn unless named")
      ->type_name("PX[@CAPTURE:SENSOR]")
      ->group(group);
  verb.add_option("--refocus", words.refocus,
                  "A lens is focused anew during the visit: its focal length is longer by this")
      ->type_name("RATIO[@AT][:CAMERA]")
      ->group(group);
  verb.add_option("--lens-misfit", disturb.lens_misfit_px,
                  "Every camera's pictures are bent by a fixed smooth field: rms of each coordinate")
      ->type_name("PX")
      ->group(group);
  verb.add_option("--visit-scatter", words.visit_scatter,
                  "Sigma per axis of every sensor's pose on this visit (this seed) about the rig's")
      ->type_name("MM,DEG")
      ->group(group);
  verb.add_option("--board-bend", disturb.board_bend_m, "Boards are cylinders or saddles: height at the corner")
      ->type_name("M")
      ->group(group);
  verb.add_option("--board-stretch", disturb.board_stretch_ratio,
                  "What is printed on the boards is longer along its columns by this")
      ->type_name("RATIO")
      ->group(group);
  verb.add_option("--mixed-pixels", disturb.mixed_pixels_ratio,
                  "Part of a lidar's beams at edges that measure between both surfaces")
      ->type_name("RATIO")
      ->group(group);
  verb.add_option("--incidence-bias", disturb.incidence_bias_m,
                  "Lidars measure too long by this at 60 degrees of incidence")
      ->type_name("M")
      ->group(group);
  AddMounts(verb, words, group);
  verb.add_option("--sway", words.sway, "The robot does not stop for captures: its speed per second, rms")
      ->type_name("M,DEG")
      ->group(group);
  verb.add_option("--pose-clock-offset", words.pose_clock_offset_ms,
                  "A tracker's clock is late by this (negative: early), and the robot sways (0.2,10 unless --sway)")
      ->type_name("MS")
      ->group(group);
  verb.add_option("--bursts", disturb.burst, "Captures in a row from nearly one place (default 1)")
      ->type_name("N")
      ->group(group);
}

}  // namespace rigcal::client
