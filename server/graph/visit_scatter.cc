#include "server/graph/visit_scatter.h"

#include <Eigen/Cholesky>

namespace rigcal::graph {
namespace {

constexpr int kHalvings = 60;

double SquaresAt(const std::vector<VisitResidual>& visits, int part, double variance) {
  double squares = 0.0;
  for (const VisitResidual& visit : visits) {
    Eigen::Matrix3d C = visit.own.block<3, 3>(part, part);
    C.diagonal().array() += variance;
    squares += visit.e.segment<3>(part).dot(C.ldlt().solve(visit.e.segment<3>(part)));
  }
  return squares;
}

double VarianceOf(const std::vector<VisitResidual>& visits, int part, int means) {
  const double expected = 3.0 * (static_cast<double>(visits.size()) - means);
  if (expected <= 0 || SquaresAt(visits, part, 0.0) <= expected) return 0.0;
  double low = 0.0, high = 0.0;
  for (const VisitResidual& visit : visits) high += visit.e.segment<3>(part).squaredNorm();  // sum e^2 / high <= 1
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (SquaresAt(visits, part, middle) > expected ? low : high) = middle;
  }
  return high;
}

}  // namespace

Matrix6d VisitVariance::Matrix() const {
  Vector6d diagonal;
  diagonal << Eigen::Vector3d::Constant(translation_m2), Eigen::Vector3d::Constant(rotation_rad2);
  return diagonal.asDiagonal();
}

VisitVariance BetweenVisits(const std::vector<VisitResidual>& visits, int means) {
  return {VarianceOf(visits, tangent::kTranslation, means), VarianceOf(visits, tangent::kRotation, means)};
}

}  // namespace rigcal::graph
