// How a pair of sensors is calibrated: one row per method. A new one is a row here, a case of Applies(), and in
// server/pipeline and client/check a case that names its loader and its estimator; every switch over Method has a case
// of each, so that the compiler says what is missing.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "server/model/sessions/session.h"

namespace rigcal {

// clang-format off: one line per row
enum class Method {
  kStereo,
  kNonOverlapping,
  kLidarCamera,
  kLidarLidar,
  kTrackerCamera,
  kTrackerLidar,
  kPoseStreams,
  kEyeToHand
};
// clang-format on

// Captures in which both sensors see what a method goes by. Zeros: it does not go by captures.
struct CapturesNeeded {
  std::size_t least = 0;   // fewer: there is no answer
  std::size_t enough = 0;  // fewer: a note on the edge says that its uncertainty is rough
  friend bool operator==(const CapturesNeeded&, const CapturesNeeded&) = default;
};

struct MethodRow {
  Method method;
  std::string_view name;           // in edges: stored, on the wire, in files
  std::string_view label;          // on pages
  SensorKind a, b;                 // of its sensors, in the order of SensorKind
  std::string_view residual_unit;  // of a capture's rms: "px" | "m"
  bool board_stands_still;         // during the session, or on what carries it
  CapturesNeeded captures;
};

// clang-format off: one line per row
inline constexpr std::array<MethodRow, 8> kMethods = {{
    {Method::kStereo, "stereo", "stereo", SensorKind::kCamera, SensorKind::kCamera, "px", false, {3, 8}},
    {Method::kNonOverlapping,
     "non_overlapping",
     "non-overlapping",
     SensorKind::kCamera,
     SensorKind::kCamera,
     "m",
     true,
     {4, 10}},
    {Method::kLidarCamera,
     "lidar_camera",
     "lidar-camera",
     SensorKind::kCamera,
     SensorKind::kLidar,
     "m",
     false,
     {4, 10}},
    {Method::kLidarLidar, "lidar_lidar", "lidar-lidar", SensorKind::kLidar, SensorKind::kLidar, "m", false, {1, 8}},
    {Method::kTrackerCamera,
     "tracker_camera",
     "tracker-camera",
     SensorKind::kCamera,
     SensorKind::kTracker,
     "m",
     true,
     {4, 10}},
    {Method::kTrackerLidar,
     "tracker_lidar",
     "tracker-lidar",
     SensorKind::kLidar,
     SensorKind::kTracker,
     "m",
     true,
     {4, 10}},
    {Method::kPoseStreams,
     "pose_streams",
     "pose streams",
     SensorKind::kPoseStream,
     SensorKind::kPoseStream,
     "m",
     false,
     {}},
    {Method::kEyeToHand, "eye_to_hand", "eye-to-hand", SensorKind::kCamera, SensorKind::kTracker, "px", true, {4, 10}},
}};
// clang-format on
static_assert([] {
  for (std::size_t i = 0; i < kMethods.size(); ++i)
    if (kMethods[i].method != static_cast<Method>(i) || kMethods[i].b < kMethods[i].a) return false;
  return kMethods.back().method == Method::kEyeToHand;
}());

// What is known of a method: its row above.
[[nodiscard]] constexpr const MethodRow& RowOf(Method method) { return kMethods[static_cast<std::size_t>(method)]; }
// As edges and documents spell it.
[[nodiscard]] inline std::string NameOf(Method method) { return std::string(RowOf(method).name); }
// Of an edge's method; nothing where it is not one of ours ("given", or another program's).
[[nodiscard]] std::optional<Method> MethodNamed(std::string_view name);
// Nothing: this pair cannot be calibrated. `a` and `b` in either order.
[[nodiscard]] std::optional<Method> MethodFor(const SessionHeader& header, const Sensor& a, const Sensor& b);

}  // namespace rigcal
