#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "server/graph/fusion/session_fusion.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

constexpr int kHalvings = 60;

// e^T (C + v I)^-1 e is the sum of square / (variance + v), along the axes of C.
struct AlongAxis {
  double square = 0.0, variance = 0.0;
};

std::vector<AlongAxis> AlongAxes(const std::vector<VisitResidual>& visits, int part) {
  std::vector<AlongAxis> axes;
  for (const VisitResidual& visit : visits) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(visit.own.block<3, 3>(part, part));
    const Eigen::Vector3d e = eigen.eigenvectors().transpose() * visit.e.segment<3>(part);
    for (int i = 0; i < 3; ++i) axes.push_back({e(i) * e(i), std::max(0.0, eigen.eigenvalues()(i))});
  }
  return axes;
}

double SquaresAt(const std::vector<AlongAxis>& axes, double variance) {
  double squares = 0.0;
  for (const AlongAxis& axis : axes)
    if (axis.square > 0.0) squares += axis.square / (axis.variance + variance);
  return squares;
}

// The squares fall as the variance grows, from more than is expected at `low` to less at `high`.
double VarianceBetween(const std::vector<AlongAxis>& axes, double expected, double low, double high) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (SquaresAt(axes, middle) > expected ? low : high) = middle;
  }
  return high;
}

double VarianceOf(const std::vector<VisitResidual>& visits, int part, double means) {
  const double expected = 3.0 * (static_cast<double>(visits.size()) - means);
  if (expected <= 0) return 0.0;
  const std::vector<AlongAxis> axes = AlongAxes(visits, part);
  if (SquaresAt(axes, 0.0) <= expected) return 0.0;
  double high = 0.0;
  for (const AlongAxis& axis : axes) high += axis.square;  // sum e^2 / high <= 1
  return VarianceBetween(axes, expected, 0.0, high);
}

// Zeros where the visits agree so well, or are so few, that an axis shows nothing.
ThreeAxes RatioOfAxes(const std::vector<VisitResidual>& visits, int part, double variance, double means) {
  ThreeAxes ratio{};
  const double redundancy = static_cast<double>(visits.size()) - means;
  for (int axis = 0; axis < 3; ++axis)
    for (const VisitResidual& visit : visits) {
      const double expected = visit.own(part + axis, part + axis) + variance;
      if (!(expected > 0) || redundancy <= 0) return {};
      ratio[static_cast<std::size_t>(axis)] += visit.e(part + axis) * visit.e(part + axis) / expected / redundancy;
    }
  return ratio;
}

ScatterOfAxes ShownAlong(const std::vector<VisitResidual>& visits, int part, double means) {
  ScatterOfAxes shown;
  if (visits.empty()) return shown;
  const std::vector<AlongAxis> axes = AlongAxes(visits, part);
  double surest = std::numeric_limits<double>::infinity();
  for (const AlongAxis& axis : axes) {
    shown.own += axis.variance / static_cast<double>(axes.size());
    surest = std::min(surest, axis.variance);
  }
  shown.dof = std::max(0.0, 3.0 * (static_cast<double>(visits.size()) - means));
  shown.between = VarianceOf(visits, part, means);
  if (shown.dof > 0 && !(shown.between > 0)) shown.between = VarianceBetween(axes, shown.dof, -surest, 0.0);
  shown.ratio = RatioOfAxes(visits, part, shown.between, means);
  return shown;
}

}  // namespace

Matrix6d VisitVariance::Matrix() const {
  return by_axis.value_or(EachAxis(translation_m2, rotation_rad2)).asDiagonal();
}

VisitVariance BetweenVisits(const std::vector<VisitResidual>& visits, const MeansTaken& means) {
  return {VarianceOf(visits, tangent::kTranslation, means.translation),
          VarianceOf(visits, tangent::kRotation, means.rotation)};
}

double AxesThatScatter(const std::vector<VisitResidual>& visits, int part, double variance, int means) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const VisitResidual& visit : visits) {
    const Eigen::Vector3d expected = visit.own.diagonal().segment<3>(part).array() + variance;
    const Eigen::Vector3d w = visit.e.segment<3>(part).cwiseQuotient(expected.cwiseSqrt());
    scatter += w * w.transpose();
  }
  const double redundancy = static_cast<double>(visits.size()) - means;
  if (redundancy < 2 || !(scatter.trace() > 0)) return 3.0;  // one visit more tells one direction, whatever scatters
  const double shown = 3 * scatter.squaredNorm() / (scatter.trace() * scatter.trace());
  const double by_chance = 3 * (redundancy + 4) / (3 * redundancy + 2);
  return 3 / std::clamp(1 + 2 * (shown - by_chance) / (3 - by_chance), 1.0, 3.0);
}

VisitScatter ScatterShown(const std::vector<VisitResidual>& visits, const MeansTaken& means) {
  return {ShownAlong(visits, tangent::kTranslation, means.translation),
          ShownAlong(visits, tangent::kRotation, means.rotation)};
}

}  // namespace rigcal::graph
