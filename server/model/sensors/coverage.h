// Where in a camera's pictures corners were seen, and where the board still has to be held.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "server/model/sensors/camera_fit.h"

namespace rigcal {

// The picture in fields of equal size, about square.
struct Coverage {
  int columns = 0, rows = 0;
  std::vector<int> corners;              // of every field, row by row
  double share_ratio = 0.0;              // of the fields that have a corner
  std::array<double, 4> margin_ratio{};  // without a corner at the left, right, top, bottom; of width or height
  // Corners in a field; column and row count from 0 at the top left and are not checked.
  [[nodiscard]] int At(int column, int row) const { return corners[static_cast<std::size_t>(row * columns + column)]; }
};
// Of all views of the camera together; where it saw no corner the share and the margins are 0.
[[nodiscard]] Coverage CoverageOf(const CameraFit& fit);

inline constexpr std::array<const char*, 4> kSidesOfPicture = {"left", "right", "top", "bottom"};
// A side whose margin is larger is empty: what the lens does there is a guess.
inline constexpr double kEmptyMargin_ratio = 0.12;
// A board that is tilted by less is flat: it tells little of the focal length. Boards whose distances differ by less
// were at one distance.
inline constexpr double kFlatTilt_rad = 0.26, kSameDistance_ratio = 1.2;

// Of `size_px` pixels in a row, in `fields` of equal size: the one that a corner lies in. A corner beyond the picture's
// edge counts to the field there. Pixel 0 reaches from -0.5 to 0.5.
[[nodiscard]] int FieldOf(double at_px, int size_px, int fields);
// Where the middle of a field is: FieldOf the other way round.
[[nodiscard]] double MiddleOf(int field, int size_px, int fields);
// So many rows make fields of so many columns about square.
[[nodiscard]] int RowsFor(const CameraFit& fit, int columns);

}  // namespace rigcal
