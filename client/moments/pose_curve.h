// A track of poses as a curve over time, and its speeds.
#pragma once

#include <optional>
#include <vector>

#include "client/moments/pose_track.h"

namespace rigcal::moments {

// Longer without a pose, nothing is said of what is in between.
constexpr double kTrackGap_s = 0.16;

// At a time between poses that are near enough: cubic in the tangent at the pose before, with the slopes of its
// neighbours (Catmull & Rom 1974). `track` is by time.
[[nodiscard]] std::optional<Se3> PoseAt(const std::vector<TimedPose>& track, double t_s);

struct TimedSpeed {
  double t_s = 0, m_s = 0, rad_s = 0;  // of a point of the board, and of its turning
};
// Between poses next to each other.
[[nodiscard]] std::vector<TimedSpeed> SpeedsOf(const std::vector<TimedPose>& track,
                                               const Eigen::Vector3d& point_board_m);
// Between two that are near enough, linear.
[[nodiscard]] std::optional<TimedSpeed> SpeedAt(const std::vector<TimedSpeed>& speeds, double t_s);

}  // namespace rigcal::moments
