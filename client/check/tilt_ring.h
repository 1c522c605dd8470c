// To which sides a camera's boards were tilted, and how far away they were.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "server/model/sensors/camera_fit.h"
#include "server/model/sensors/target.h"

namespace rigcal::check {

// A board is tilted to a side that is nearer to the camera than the opposite one, by the angle between its normal and
// the line of sight (camera_fit.h).
struct TiltRing {
  std::array<double, 4> largest_rad{};  // to the left, right, up, down; never below 0
  std::array<std::size_t, 4> views{};   // tilted there by kFlatTilt_rad (coverage.h) or more
};
inline constexpr std::array<const char*, 4> kTiltSides = {"left", "right", "up", "down"};
// Of fewer, a side of the ring is open: one pose of a board seen small may be the wrong one of two.
inline constexpr std::size_t kTiltedViewsMin = 2;

// Of views whose board has a pose.
[[nodiscard]] TiltRing RingOf(const CameraFit& fit);
// "left and up": the open sides; empty if there is none.
[[nodiscard]] std::string OpenSides(const TiltRing& ring);
// So many more captures close the ring: one board may be tilted left or right and up or down at once.
[[nodiscard]] std::size_t CapturesToClose(const TiltRing& ring);

// Of the board's middle, in widths of its pattern.
struct BoardDistances {
  double near_widths = 0.0, far_widths = 0.0;
};
// Nothing where no board has a pose.
[[nodiscard]] std::optional<BoardDistances> DistancesOf(const CameraFit& fit, const Target& board);

}  // namespace rigcal::check
