// A calibration board: its printed pattern and the plate that carries it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"

namespace rigcal {

// "checkerboard"; "charuco": a checkerboard with markers in its white squares; "aruco_grid": separate markers, numbered
// from the top left, row by row (OpenCV's GridBoard); "april_grid": the same, numbered from the bottom left (Kalibr's);
// "circle_grid": circles in rows and columns; "asymmetric_circle_grid": every other row shifted by half of the distance
// between neighbours in a row (OpenCV's).
enum class TargetKind { kCheckerboard, kCharuco, kArucoGrid, kAprilGrid, kCircleGrid, kAsymmetricCircleGrid };
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(TargetKind kind);
[[nodiscard]] Result<TargetKind> TargetKindOf(const std::string& name);
// Whether the board is made of separate markers (a grid), and not of squares.
[[nodiscard]] inline bool IsTagGrid(TargetKind kind) {
  return kind == TargetKind::kArucoGrid || kind == TargetKind::kAprilGrid;
}
// Whether its points are centres of circles.
[[nodiscard]] inline bool IsCircleGrid(TargetKind kind) {
  return kind == TargetKind::kCircleGrid || kind == TargetKind::kAsymmetricCircleGrid;
}
// What cols and rows count: "inner corners", "tags" or "circles".
[[nodiscard]] const char* CountedOf(TargetKind kind);
// What square_m is called in session.yaml: "square_size_m", "tag_size_m" or "spacing_m".
[[nodiscard]] const char* SizeFieldOf(TargetKind kind);

// The board's frame: origin at the top left point, x along columns, y along rows, z into the board (right-handed, seen
// from the front). Point indices are those of TargetPoints().
struct Target {
  TargetId id;
  int cols = 0, rows = 0;  // inner corners (checkerboard, charuco), tags or circles (grids)
  // Side of a square; of a grid of tags: side of a tag's black border; of circles: from one row of centres to the next,
  // which is the distance of neighbours in a row, or half of it (asymmetric).
  double square_m = 0.0;
  double square_sigma_m = 0.0;  // standard deviation of the mean measured square_m; 0: taken as exact
  std::string serial;
  TargetKind kind = TargetKind::kCheckerboard;
  std::string dictionary = {};  // of the markers, OpenCV's name: "DICT_4X4_50", "DICT_APRILTAG_36h11"; empty: none
  double marker_m = 0.0;        // charuco: side of a marker
  bool legacy_layout = false;  // charuco: first square white where OpenCV >= 4.6 prints it black (even rows of squares)
  double spacing_ratio = 0.0;  // grids: gap between tags over the tag's side
  std::optional<Eigen::Vector2d> plate_m = {};  // outer width (along columns) and height of the plate
  // The tracker whose body carries the board (a robot's flange); absent: it stands still, or is carried about by hand.
  std::optional<SensorId> mounted_on = {};
  double diameter_m = 0.0;  // of the circles
  // The ids of its markers in the order in which they are numbered; empty: 0, 1, 2, ...
  std::vector<int> marker_ids = {};
  // From the middle of the pattern to the middle of the plate, along columns and rows; absent: none.
  std::optional<Eigen::Vector2d> plate_offset_m = {};
  friend bool operator==(const Target&, const Target&) = default;
};

// All points of the pattern, metres, z = 0. Checkerboard and charuco: point r * cols + c is inner corner (c, r) at
// (c square, r square). Grids: point 4 t + i is corner i (top left, top right, bottom right, bottom left of the tag as
// printed) of tag t. Circles: point r * cols + c is the centre of circle c of row r, at (c square, r square);
// asymmetric: at ((2 c + r % 2) square, r square).
[[nodiscard]] std::vector<Eigen::Vector3d> TargetPoints(const Target& target);
// The middle of the pattern, and that of the plate, in the board's frame.
[[nodiscard]] Eigen::Vector3d CentreOf(const Target& target);
[[nodiscard]] Eigen::Vector3d PlateCentreOf(const Target& target);
// How many markers it has, and their ids, those of the places in which they are numbered; none of a board without.
[[nodiscard]] int MarkerCountOf(const Target& target);
[[nodiscard]] std::vector<int> MarkerIdsOf(const Target& target);
// Width and height of the printed pattern (with its outer squares, or to the edges of its circles), metres.
[[nodiscard]] Eigen::Vector2d PatternSize_m(const Target& target);
// Orientations in which the pattern looks the same: a checkerboard with both counts odd or both even has 2, a square
// one with even counts 4; a circle_grid 2, a square one 4; everything else 1 (an asymmetric grid has an odd number of
// rows).
[[nodiscard]] int SymmetryOf(const Target& target);
// The index that point `idx` has when the board is taken as turned by turn * 360 / SymmetryOf degrees about its centre
// (clockwise seen from the front).
[[nodiscard]] int TurnedIndex(const Target& target, int idx, int turn);

// Whether a picture of one may be taken for a picture of the other, at any distance.
[[nodiscard]] bool LookAlike(const Target& a, const Target& b);

// Counts, sizes and dictionary in range. The error names the target and the field.
[[nodiscard]] Status Validate(const Target& target);

}  // namespace rigcal
