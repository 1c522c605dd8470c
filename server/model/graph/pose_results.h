// The six results of a pose by name: three shifts, then three turns.
#pragma once

#include <array>

namespace rigcal {

// By the robot's axes, and where these are not known by those of the frame that the pose is told in.
inline constexpr std::array<const char*, 6> kRobotResults = {"forward", "sideways", "height", "roll", "pitch", "yaw"};
inline constexpr std::array<const char*, 6> kFrameResults = {"x", "y", "z", "rx", "ry", "rz"};

}  // namespace rigcal
