// Which moments of a stream are captures: those at which everything stands still, sharp and well exposed. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/moments/sight.h"

namespace rigcal::moments {

struct MomentLimits {
  double motion_px = 0.5, motion_m = 0.001;  // that a moment may move by, in the picture and on the board
  std::int64_t every_ns = 0;                 // from one capture to the next, at least
};

// What a sensor took, its stamps on the rig's one clock.
struct Stream {
  enum class Kind { kCamera, kCloud, kPoses };
  Kind kind = Kind::kCamera;
  std::vector<std::int64_t> stamps_ns;         // of its messages, in any order; whose clock is not known: as they are
  std::vector<Sight> sights;                   // of a camera, as stamps_ns
  std::vector<Eigen::Vector3d> places_m;       // of poses, as stamps_ns
  std::optional<std::int64_t> clock_sigma_ns;  // how far its clock may be off; absent: not known
};

// One instant of several sensors, of each the message or nothing.
struct Moment {
  std::int64_t stamp_ns = 0;
  std::vector<std::optional<std::size_t>> message;
};

enum class LeftOut { kNoBoard, kMoved, kMotionUnknown, kBlurred, kExposure, kSamePlace, kTooSoon };
constexpr std::size_t kLeftOutReasons = 7;
// "the board was not in view of two sensors", "something moved", ...
[[nodiscard]] std::string Words(LeftOut why);
// "no_board", "moved", "motion_unknown", "blurred", "exposure", "same_place", "too_soon".
[[nodiscard]] std::string NameOf(LeftOut why);

struct Choice {
  std::vector<Moment> kept;  // by stamp; pictures that will not do are taken out of them
  std::size_t moments = 0;   // in all
  std::array<std::size_t, kLeftOutReasons> left_out{};
  double least_motion_px = 0, least_motion_m = 0;  // of what was left out as moving: the stillest, and the middle one
  double usual_motion_px = 0, usual_motion_m = 0;
  double worst_kept_px = 0, worst_kept_m = 0;  // of what was kept
};

// A moment's motion is how far the board's corners, or the places of poses, of each of its messages are from where they
// are just before and after it: in all messages within the time by which the moment's messages are apart, three sigmas
// of clocks, a cloud's sweep and an exposure, and in the next one on either side at least. Beyond the limits it is left
// out. A picture without the board, blurred or not well exposed is taken out; with less than `sensors_min` other
// sensors (poses count) the moment is left out. Of moments one after the other at one place that with the most sensors
// is kept, of those the stillest.
[[nodiscard]] Choice Choose(const std::vector<Stream>& streams, const std::vector<Moment>& moments,
                            const MomentLimits& limits, std::size_t sensors_min);

}  // namespace rigcal::moments
