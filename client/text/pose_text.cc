#include "client/text/pose_text.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "client/text/table.h"
#include "server/math/roll_pitch_yaw.h"

namespace rigcal::client {
namespace {

std::optional<Eigen::Vector4d> QuaternionOf(const Document& list) {
  Eigen::Vector4d q_xyzw;
  for (Eigen::Index i = 0; i < 4; ++i) {
    const auto value = list[static_cast<std::size_t>(i)].Number();
    if (!value) return std::nullopt;
    q_xyzw[i] = *value;
  }
  if (q_xyzw.norm() == 0.0) return std::nullopt;
  return q_xyzw;
}

}  // namespace

Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& R) { return RollPitchYawOf(R); }

Eigen::Vector3d RollPitchYaw(const Eigen::Vector4d& q_xyzw) {
  return RollPitchYaw(Eigen::Quaterniond(q_xyzw).normalized().toRotationMatrix());
}

std::string Triple(const Document& list, double scale, int digits) {
  if (list.size() != 3) return "-";
  std::string text;
  for (std::size_t i = 0; i < 3; ++i) text += (i > 0 ? " " : "") + Scaled(list[i].Number(), scale, digits);
  return text;
}

std::optional<double> LengthOf(const Document& list, std::size_t first) {
  double sum = 0.0;
  for (std::size_t i = first; i < first + 3; ++i) {
    const auto value = list[i].Number();
    if (!value) return std::nullopt;
    sum += *value * *value;
  }
  return std::sqrt(sum);
}

std::string RpyText(const Document& pose, int digits) {
  const auto q_xyzw = QuaternionOf(pose["q_xyzw"]);
  if (!q_xyzw) return "-";
  const Eigen::Vector3d rpy_deg = RollPitchYaw(*q_xyzw) * kDegPerRad;
  return Fixed(rpy_deg[0], digits) + " " + Fixed(rpy_deg[1], digits) + " " + Fixed(rpy_deg[2], digits);
}

void PrintMatrix(const Document& rows, const std::string& indent, std::ostream& out) {
  for (const Document& row : rows.Items()) {
    out << indent;
    for (const Document& value : row.Items()) {
      std::array<char, 32> text{};
      std::snprintf(text.data(), text.size(), " %12.4e", value.Number().value_or(0.0));
      out << text.data();
    }
    out << '\n';
  }
}

}  // namespace rigcal::client
