// Poses and uncertainties as text for people: millimetres and degrees.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <ostream>
#include <string>

#include "client/text/document.h"

namespace rigcal::client {

inline constexpr double kMmPerM = 1e3;
inline constexpr double kDegPerRad = 57.29577951308232;

// Roll, pitch, yaw (rad) of R = Rz(yaw) Ry(pitch) Rx(roll); roll is 0 where pitch is +-90 degrees.
[[nodiscard]] Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& R);
// The same of [x, y, z, w] (any length but zero).
[[nodiscard]] Eigen::Vector3d RollPitchYaw(const Eigen::Vector4d& q_xyzw);

// "83.180 -0.920 0.120" of a JSON list of three, each times `scale`; "-" for an absent list or entry.
[[nodiscard]] std::string Triple(const Document& list, double scale, int digits);
// Length of three entries of a list, from `first` on.
[[nodiscard]] std::optional<double> LengthOf(const Document& list, std::size_t first);
// Roll, pitch, yaw in degrees of a pose {"p_m", "q_xyzw"}.
[[nodiscard]] std::string RpyText(const Document& pose, int digits);
// Six lines of six numbers, each line after `indent`.
void PrintMatrix(const Document& rows, const std::string& indent, std::ostream& out);

}  // namespace rigcal::client
