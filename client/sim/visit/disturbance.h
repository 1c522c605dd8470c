// What goes wrong on a visit beyond noise: what a calibration takes for granted and what is not so. Nothing by default;
// what is not named is drawn from the seed.
#pragma once

#include <optional>

#include "server/base/ids.h"

namespace rigcal::sim {

struct Displacement {
  double m = 0.0, rad = 0.0;
};

// One sensor's file of one capture.
struct Recording {
  CaptureId capture;
  SensorId sensor;
};

struct BoardMove {
  Displacement by;
  double at_ratio = 0.5;  // of the captures that were taken before
  std::optional<TargetId> board;
};

struct WrongInstant {
  std::optional<Recording> of;
};

struct CaptureShift {
  double px = 0.0;  // of the whole picture, in one direction
  std::optional<Recording> of;
};

// A lens that is focused anew during the visit, by itself or by a knock: its picture is larger by this from then on.
struct Refocus {
  double by_ratio = 0.0;
  double at_ratio = 0.5;  // of the captures that were taken before
  std::optional<SensorId> camera;
};

// A sensor that is leaned on, or slips and is put back: elsewhere during a part of the captures, then as before.
struct Excursion {
  Displacement by;
  double from_ratio = 0.5, until_ratio = 0.7;
  std::optional<SensorId> sensor;
};

// A mount that gives way, evenly from the first capture to the last.
struct Creep {
  Displacement by;
  std::optional<SensorId> sensor;
};

struct Disturbances {
  double lens_misfit_px = 0.0;  // of each camera: rms of a fixed smooth field of shifts
  double pupil_shift_m = 0.0;   // of each camera's entrance pupil, see CameraTruth; of features only, not of pictures
  bool pupil_by_tangent = false;
  std::optional<BoardMove> board_move;
  std::optional<WrongInstant> wrong_instant;  // what one sensor tells of a capture is of another instant
  std::optional<CaptureShift> capture_shift;
  std::optional<Refocus> refocus;
  std::optional<Excursion> excursion;
  std::optional<Creep> creep;
  Displacement rattle;               // sigma per axis of every sensor on its mount, at each capture anew
  Displacement pose_drift;           // of each tracker's world: a random walk, sigma per axis from capture to capture
  Displacement visit_scatter;        // sigma per axis of every sensor's pose on this visit about the rig's
  double board_bend_m = 0.0;         // of every board: height of its corner over its middle
  double board_stretch_ratio = 0.0;  // of every board: its print is longer along its columns by this
  double mixed_pixels_ratio = 0;     // of a lidar's beams that meet an edge: their range lies between both surfaces
  double incidence_bias_m = 0.0;     // that a lidar measures too long at 60 degrees of incidence; none head-on
  Displacement sway_per_s;           // speed of the body at captures, rms; a tracker then tells its path as well
  double pose_clock_late_s = 0;      // what a tracker tells for a moment is where its body was by this before
  int burst = 1;                     // captures in a row from nearly one place, with corner errors in common
};

}  // namespace rigcal::sim
