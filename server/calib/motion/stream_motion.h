// Two streams of poses of one body, each by its own clock: the offset of the clocks, and poses of the same instants.
#pragma once

#include <optional>
#include <vector>

#include "server/calib/motion/motion_problem.h"
#include "server/model/sensors/pose_table.h"

namespace rigcal::calib {

struct ClockOffset {
  double offset_s = 0.0;           // t_a = t_b + offset, both since the first rows
  double correlation_ratio = 0.0;  // of the angular speeds at that offset: 1 is perfect
};

// From the first row to the last, and the farthest that it turned from its first pose. Nothing of an empty stream.
struct StreamSpan {
  double seconds = 0.0, turn_rad = 0.0;
};
// The rows are in the order of their stamps.
[[nodiscard]] StreamSpan SpanOf(const PoseTable& stream);
// How long both run at once if b's first row comes `offset_s` after a's; 0: never.
[[nodiscard]] double SecondsInCommon(const PoseTable& a, const PoseTable& b, double offset_s);

// By correlation of the angular speeds over every offset at which the streams overlap by a fair part. Nothing where
// they cannot overlap or do not turn.
[[nodiscard]] std::optional<ClockOffset> CorrelateClocks(const PoseTable& a, const PoseTable& b);

// Between rows: longer, and nothing is interpolated.
constexpr double kStreamGapMax_s = 0.5;

// Pose and velocity of a stream at a time since its first row, between two rows; nothing outside, or in a gap.
struct StreamPose {
  Se3 T_world_body;
  Vector6d twist = Vector6d::Zero();  // right tangent, per second
};
// The stream has at least two rows; between them the motion is of constant twist.
[[nodiscard]] std::optional<StreamPose> PoseAt(const PoseTable& stream, double time_s);

// Where both have poses: rows of a, evenly spread over the path, and b interpolated.
struct CommonPoses {
  std::vector<double> times_s;  // of a's clock, since its first row
  std::vector<Se3> a;
  std::vector<StreamPose> b;
};
// `offset_s`: as in ClockOffset. About 400, or as many as there are rows; none where the streams do not overlap.
[[nodiscard]] CommonPoses PosesInCommon(const PoseTable& a, const PoseTable& b, double offset_s);

}  // namespace rigcal::calib
