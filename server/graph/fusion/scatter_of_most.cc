#include "server/graph/fusion/scatter_of_most.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "server/math/statistics.h"

namespace rigcal::graph {
namespace {

constexpr std::size_t kPlacesMin = 5;
constexpr int kHalvingsOfMost = 50;
// Times what the places say: of eight of which one was moved, one in a thousand comes above it by chance, along three
// axes and along one.
constexpr double kScattersOfThree = 4.0, kScattersOfOne = 12.0;
constexpr double kAxisApart = 3.0;  // one axis over what the three show, where it goes by itself

// The difference of two places along axes in which its covariance is diagonal.
struct PlaceDifference {
  Eigen::Vector3d squares, variances;
};
using PlaceDifferences = std::vector<PlaceDifference>;

struct TwoPlaces {
  Vector6d apart;
  Matrix6d covariance;
};

std::vector<TwoPlaces> EachAndTheNext(const std::vector<MeasuredPlace>& places) {
  std::vector<TwoPlaces> pairs;
  for (std::size_t i = 1; i < places.size(); ++i)
    pairs.push_back(
        {(places[i - 1].T_a_b.Inverse() * places[i].T_a_b).Log(), places[i - 1].covariance + places[i].covariance});
  return pairs;
}

PlaceDifferences AlongThree(const std::vector<TwoPlaces>& pairs, int part) {
  PlaceDifferences differences;
  for (const TwoPlaces& pair : pairs) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(pair.covariance.block<3, 3>(part, part));
    differences.push_back({(axes.eigenvectors().transpose() * pair.apart.segment<3>(part)).cwiseAbs2(),
                           axes.eigenvalues().cwiseMax(0.0)});
  }
  return differences;
}

PlaceDifferences AlongOne(const std::vector<TwoPlaces>& pairs, int axis) {
  PlaceDifferences differences;
  for (const TwoPlaces& pair : pairs)
    differences.push_back({Eigen::Vector3d(pair.apart[axis] * pair.apart[axis], 0, 0),
                           Eigen::Vector3d(pair.covariance(axis, axis), 0, 0)});
  return differences;
}

double SquareAt(const PlaceDifference& difference, double variance) {
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    if (difference.squares[axis] > 0) square += difference.squares[axis] / (difference.variances[axis] + 2 * variance);
  return square;
}

// The squared difference, in sigmas, that half of them do not exceed.
double HalfAt(const PlaceDifferences& differences, double variance) {
  std::vector<double> squares;
  for (const PlaceDifference& difference : differences) squares.push_back(SquareAt(difference, variance));
  const auto half = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() - 1) / 2;
  std::nth_element(squares.begin(), half, squares.end());
  return *half;
}

double VarianceOfMost(const PlaceDifferences& differences, double axes, double scatters_ratio) {
  const double expected = ChiSquareQuantile(0.5, axes);
  if (HalfAt(differences, 0.0) <= scatters_ratio * expected) return 0.0;
  double low = 0.0, high = 0.0;
  for (const PlaceDifference& difference : differences) high = std::max(high, difference.squares.sum());
  high /= expected;
  for (int i = 0; i < kHalvingsOfMost; ++i) {
    const double middle = 0.5 * (low + high);
    (HalfAt(differences, middle) > expected ? low : high) = middle;
  }
  return high;
}

}  // namespace

Matrix6d ScatterOfMost(const std::vector<MeasuredPlace>& places) {
  if (places.size() < kPlacesMin) return Matrix6d::Zero();
  const std::vector<TwoPlaces> pairs = EachAndTheNext(places);
  Vector6d variance;
  for (const int part : {tangent::kTranslation, tangent::kRotation}) {
    const double together = VarianceOfMost(AlongThree(pairs, part), 3.0, kScattersOfThree);
    for (int axis = part; axis < part + 3; ++axis) {
      const double alone = VarianceOfMost(AlongOne(pairs, axis), 1.0, kScattersOfOne);
      variance[axis] = alone > kAxisApart * together ? alone : together;
    }
  }
  return variance.asDiagonal();
}

}  // namespace rigcal::graph
