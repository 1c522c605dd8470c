// A calibration board as a reference standard: what somebody measured of it. All that a robot says in metres rests on
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/model/approval/standing.h"
#include "server/model/sensors/target.h"

namespace rigcal {

// What a board with a serial is to be. Counts and `square_m` are those of Target.
struct BoardPattern {
  TargetKind kind = TargetKind::kCheckerboard;
  int cols = 0, rows = 0;
  double square_m = 0.0;  // as it was to be printed
  friend bool operator==(const BoardPattern&, const BoardPattern&) = default;
};
// As the session has the board.
[[nodiscard]] BoardPattern PatternOf(const Target& target);
// Whether a session and the registry can mean the same board: kind and counts; sizes are compared elsewhere.
[[nodiscard]] bool IsSamePattern(const BoardPattern& a, const BoardPattern& b);

// Counts as session.yaml has them: squares of a charuco, inner corners of a checkerboard, tags of a grid.
struct TypedCounts {
  int cols = 0, rows = 0;
  const char* of = "";  // "inner corners", "squares", "tags", "circles"
};
[[nodiscard]] TypedCounts TypedCountsOf(const BoardPattern& pattern);
// The other way round, of counts as people type them.
[[nodiscard]] BoardPattern PatternTyped(TargetKind kind, int cols, int rows, double square_m);
// "checkerboard of 9 x 6 inner corners, 25 mm"
[[nodiscard]] std::string TextOf(const BoardPattern& pattern);

// One check of a board with a rule. Of each serial the newest holds.
struct BoardMeasure {
  std::int64_t number = 0;  // order of arrival among those of all boards
  std::string serial;
  BoardPattern pattern;
  // Two lengths on the board, such as those of its printed rulers, along the columns (x) and the rows (y): as they were
  // to be, and as they were measured.
  double length_x_m = 0.0, length_y_m = 0.0, measured_x_m = 0.0, measured_y_m = 0.0;
  double sigma_m = 0.0;                   // standard deviation of each of the two readings
  bool sigma_is_assumed = false;          // nobody said it: kReadingSigma_m
  std::optional<double> flatness_m = {};  // largest distance of the pattern from a plane; absent: not measured
  std::optional<Stamp> next_check_at =
      {};     // the day (its first moment, UTC) up to which it holds; absent: none was set
  Word word;  // who measured, when; `reason` may be empty
};
// Of a length read off a rule with millimetres at both ends.
inline constexpr double kReadingSigma_m = 0.0002;

// The measured side of a square (of a grid: of a tag) along x and y, metres, with standard deviations.
struct BoardSize {
  double x_m = 0.0, y_m = 0.0, sigma_x_m = 0.0, sigma_y_m = 0.0;
};
[[nodiscard]] BoardSize SizeOf(const BoardMeasure& measure);
// The length that a printed ruler's last tick had, where `measured_m` was read: the nearest multiple of 100 mm.
[[nodiscard]] double RulerLength_m(double measured_m);

// Serial, pattern, lengths (within 5 % of what they were to be), sigma, flatness and dates in range. The error says
// what is wrong, and whether another unit was meant.
[[nodiscard]] Status Validate(const BoardMeasure& measure);
// Whether the day of its next check is over.
[[nodiscard]] bool IsCheckDue(const BoardMeasure& measure, Stamp at);
// Whether both say the same of the same board, on the same day (UTC), by the same person: then it is one check.
[[nodiscard]] bool IsSameCheck(const BoardMeasure& a, const BoardMeasure& b);
// Whether the measured size of a square differs, in either direction.
[[nodiscard]] bool IsSameSize(const BoardMeasure& a, const BoardMeasure& b);

// "25 mm", "24.987 mm": micrometres at most.
[[nodiscard]] std::string BoardMm(double length_m);
// "24.98 x 25.01 mm (sigma 0.03)"
[[nodiscard]] std::string TextOf(const BoardSize& size);
// The serial as a shell takes it: in quotes where it has to be.
[[nodiscard]] std::string TypedSerial(const std::string& serial);
// "rigcal board measure B-7 --ruler-x-mm A --ruler-y-mm B"; of a board that is in no registry with its `pattern`.
[[nodiscard]] std::string MeasureCommand(const std::string& serial, const BoardPattern* pattern = nullptr);

}  // namespace rigcal
