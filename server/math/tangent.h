// The one place that knows the order of a tangent vector: [translation, rotation].
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

namespace rigcal {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

namespace tangent {
constexpr int kX = 0, kY = 1, kZ = 2, kRx = 3, kRy = 4, kRz = 5;
constexpr int kTranslation = 0;  // start of the 3 translation entries
constexpr int kRotation = 3;     // start of the 3 rotation entries
constexpr std::array<std::string_view, 6> kNames = {"x", "y", "z", "rx", "ry", "rz"};
}  // namespace tangent

// One number for all axes of a translation, one for those of a rotation.
[[nodiscard]] inline Vector6d EachAxis(double translation, double rotation) {
  Vector6d axes;
  axes << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation);
  return axes;
}

}  // namespace rigcal
