#include <array>
#include <cmath>
#include <cstdio>

#include "server/graph/observability.h"

namespace rigcal::graph {
namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

// "z", or "(0.71, 0.71, 0.00)" if it is no axis.
std::string NameAxis(const Eigen::Vector3d& direction) {
  Eigen::Vector3d unit = direction.normalized();
  Eigen::Index largest = 0;
  unit.cwiseAbs().maxCoeff(&largest);
  constexpr double kAlongAxis = 0.9998;  // within a degree
  if (std::abs(unit(largest)) > kAlongAxis) return kAxes[static_cast<std::size_t>(largest)];
  if (unit(largest) < 0.0) unit = -unit;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "(%.2f, %.2f, %.2f)", unit.x() + 0.0, unit.y() + 0.0, unit.z() + 0.0);
  return text.data();
}

std::string NameDirection(const Vector6d& direction) {
  const Eigen::Vector3d translation = direction.head<3>(), rotation = direction.tail<3>();
  constexpr double kNothing = 1e-3;
  if (rotation.norm() < kNothing) return "translation along " + NameAxis(translation);
  std::string text = "rotation about " + NameAxis(rotation);
  if (translation.norm() >= kNothing) text += " coupled with translation along " + NameAxis(translation);
  return text;
}

}  // namespace

// Reduced column echelon form: every column gets a coordinate of its own, so that pure axes show as such. Rotations are
// eliminated first: what remains are pure translations.
FreeBasis Reduced(FreeBasis basis) {
  std::array<bool, 6> used{};
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    Eigen::Index row = -1, column = c;
    for (const auto& [start, count] : {std::pair(3, 3), std::pair(0, 3)}) {
      double best = 1e-3;
      for (Eigen::Index k = c; k < basis.cols(); ++k)
        for (Eigen::Index r = start; r < start + count; ++r)
          if (!used[static_cast<std::size_t>(r)] && std::abs(basis(r, k)) > best)
            best = std::abs(basis(r, k)), row = r, column = k;
      if (row >= 0) break;
    }
    if (row < 0) break;
    used[static_cast<std::size_t>(row)] = true;
    basis.col(c).swap(basis.col(column));
    basis.col(c) /= basis(row, c);
    for (Eigen::Index k = 0; k < basis.cols(); ++k)
      if (k != c) basis.col(k) -= basis(row, k) * basis.col(c);
  }
  constexpr double kRounding = 1e-9;
  return (basis.array().abs() < kRounding).select(0.0, basis);
}

std::string NameDirections(const FreeBasis& basis) {
  const FreeBasis reduced = Reduced(basis);
  std::string text;
  for (Eigen::Index c = 0; c < reduced.cols(); ++c) {
    if (c > 0) text += c + 1 == reduced.cols() ? " and " : ", ";
    text += NameDirection(reduced.col(c));
  }
  return text;
}

}  // namespace rigcal::graph
