// A calibration board: its printed pattern and the plate that carries it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

// "checkerboard"; "charuco": a checkerboard with markers in its white squares; "aruco_grid": separate markers, numbered
// from the top left, row by row (OpenCV's GridBoard); "april_grid": the same, numbered from the bottom left (Kalibr's).
enum class TargetKind { kCheckerboard, kCharuco, kArucoGrid, kAprilGrid };
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(TargetKind kind);
[[nodiscard]] Result<TargetKind> TargetKindOf(const std::string& name);
// Whether the board is made of separate markers (a grid), and not of squares.
[[nodiscard]] inline bool IsTagGrid(TargetKind kind) {
  return kind == TargetKind::kArucoGrid || kind == TargetKind::kAprilGrid;
}

// The board's frame: origin at the top left point, x along columns, y along rows, z into the board (right-handed, seen
// from the front). Point indices are those of TargetPoints().
struct Target {
  TargetId id;
  int cols = 0, rows = 0;       // inner corners (checkerboard, charuco) or tags (grids)
  double square_m = 0.0;        // side of a square; of a grid: side of a tag's black border
  double square_sigma_m = 0.0;  // standard deviation of the mean measured square_m; 0: taken as exact
  std::string serial;
  TargetKind kind = TargetKind::kCheckerboard;
  std::string dictionary = {};  // of the markers, OpenCV's name: "DICT_4X4_50", "DICT_APRILTAG_36h11"; empty: none
  double marker_m = 0.0;        // charuco: side of a marker
  bool legacy_layout = false;  // charuco: first square white where OpenCV >= 4.6 prints it black (even rows of squares)
  double spacing_ratio = 0.0;  // grids: gap between tags over the tag's side
  std::optional<Eigen::Vector2d> plate_m =
      {};  // outer width (along columns) and height of the plate; pattern centred on it
  // The tracker whose body carries the board (a robot's flange); absent: it stands still, or is carried about by hand.
  std::optional<SensorId> mounted_on = {};
  friend bool operator==(const Target&, const Target&) = default;
};

// All points of the pattern, metres, z = 0. Checkerboard and charuco: point r * cols + c is inner corner (c, r) at
// (c square, r square). Grids: point 4 t + i is corner i (top left, top right, bottom right, bottom left of the tag as
// printed) of tag t.
[[nodiscard]] std::vector<Eigen::Vector3d> TargetPoints(const Target& target);
// The middle of the pattern in the board's frame: where the plate's centre is.
[[nodiscard]] Eigen::Vector3d CentreOf(const Target& target);
// Width and height of the printed pattern (with its outer squares), metres.
[[nodiscard]] Eigen::Vector2d PatternSize_m(const Target& target);
// Orientations in which the pattern looks the same: a checkerboard with both counts odd or both even has 2, a square
// one with even counts 4; everything else 1.
[[nodiscard]] int SymmetryOf(const Target& target);
// The index that point `idx` has when the board is taken as turned by turn * 360 / SymmetryOf degrees about its centre
// (clockwise seen from the front).
[[nodiscard]] int TurnedIndex(const Target& target, int idx, int turn);

// Counts, sizes and dictionary in range. The error names the target and the field.
[[nodiscard]] Status Validate(const Target& target);

}  // namespace rigcal
