#include "server/fleet/findings/check_gaps.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "server/fleet/findings/disagreements.h"
#include "server/fleet/findings/failures.h"
#include "server/fleet/findings/not_needed.h"
#include "server/fleet/wording.h"

namespace rigcal::fleet {
namespace {

constexpr double kKnownNothing = 1e-6;  // information: to a thousand tolerances

using Half = Eigen::Matrix3d;
// Information about the first three of six, whatever the others are; what nothing is known of does not matter.
Half Alone(const Matrix6d& J, int first, int others) {
  const Eigen::SelfAdjointEigenSolver<Half> rest(J.block<3, 3>(others, others));
  Half alone = J.block<3, 3>(first, first);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d cross = J.block<3, 3>(first, others) * rest.eigenvectors().col(k);
    if (rest.eigenvalues()(k) > kKnownNothing) alone -= cross * cross.transpose() / rest.eigenvalues()(k);
  }
  return 0.5 * (alone + alone.transpose());
}

// Directions at b, orthonormal, that the others do not know to the tolerance; in its units.
struct Weak {
  Eigen::Matrix<double, 3, Eigen::Dynamic> along{3, 0};
  std::vector<double> known;  // information of the others

  void Add(const Eigen::Vector3d& direction, double information) {
    along.conservativeResize(3, along.cols() + 1);
    along.rightCols<1>() = direction;
    known.push_back(information);
  }
  // 1 sigma of the others; infinite: they say nothing of it.
  [[nodiscard]] double Sigma(const Eigen::Vector3d& direction) const {
    double variance = 0.0;
    for (Eigen::Index k = 0; k < along.cols(); ++k) {
      const double part = along.col(k).dot(direction), information = known[static_cast<std::size_t>(k)];
      if (information < kKnownNothing) return std::numeric_limits<double>::infinity();
      variance += part * part / information;
    }
    return std::sqrt(variance);
  }
  // Those that the edge itself tells to the tolerance.
  [[nodiscard]] std::vector<Eigen::Vector3d> ToldBy(const Half& edge) const {
    std::vector<Eigen::Vector3d> told;
    if (along.cols() == 0) return told;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> own(along.transpose() * edge * along);
    for (Eigen::Index k = 0; k < along.cols(); ++k)
      if (own.eigenvalues()(k) >= 1.0) told.emplace_back(along * own.eigenvectors().col(k));
    return told;
  }
};

// What they say nothing of, and what they say too little of.
std::array<Weak, 2> WeakOf(const Half& by_others) {
  std::array<Weak, 2> weak;
  const Eigen::SelfAdjointEigenSolver<Half> known(by_others);
  for (int k = 0; k < 3; ++k) {
    const double information = std::max(known.eigenvalues()(k), 0.0);
    if (information < 1.0) weak[information < kKnownNothing ? 0 : 1].Add(known.eigenvectors().col(k), information);
  }
  return weak;
}

std::optional<Se3> PlaceOf(const SensorId& sensor, const GraphSolution& solution) {
  for (const SensorPose& pose : solution.poses)
    if (pose.sensor == sensor && pose.Placed() != nullptr) return pose.Placed()->Normalized();
  return std::nullopt;
}

// The axes of one half that span these directions at b. Without a place of b they have no names.
std::vector<AxisResult> AxesAlong(const std::vector<Eigen::Vector3d>& directions, int first,
                                  const std::optional<Se3>& T_ref_b, const GraphSolution& solution) {
  std::vector<Vector6d> open;
  for (const Eigen::Vector3d& direction : directions) {
    open.emplace_back(Vector6d::Zero());
    open.back().segment<3>(first) = direction;
  }
  std::vector<AxisResult> axes =
      AxesOf(T_ref_b.value_or(Se3()), Matrix6d::Zero(), open, T_ref_b ? solution.R_ref_robot : std::nullopt);
  const auto other = [&](const AxisResult& axis) {
    return axis.turn != (first == tangent::kRotation) || axis.measured();
  };
  axes.erase(std::remove_if(axes.begin(), axes.end(), other), axes.end());
  if (!T_ref_b)
    for (AxisResult& axis : axes) axis.name.clear();
  return axes;
}

bool IsNeededOf(const Edge& edge, const AxisResult& axis, const GraphSolution& solution, const Policy& policy) {
  const SensorPose* reference = ReferenceOf(solution);
  const auto needs = [&](const SensorId& sensor) {
    return (reference == nullptr || reference->sensor != sensor) && !IsNotNeeded(axis, sensor, solution, policy);
  };
  return needs(edge.frame_a) || needs(edge.frame_b);
}

void NameGap(const std::vector<AxisResult>& axes, const GraphSolution& solution, CheckGap& gap) {
  const std::string half = gap.is_position ? "position" : "rotation";
  gap.what = "the " + half;
  if (axes.size() == 3) return;
  gap.several = axes.size() > 1;
  std::vector<std::string> names;
  for (const AxisResult& axis : axes)
    if (!axis.name.empty()) names.push_back(InSentence(axis.name));
  const SensorPose* reference = ReferenceOf(solution);
  gap.names_sensor = names.size() == axes.size() && !solution.R_ref_robot && reference != nullptr;
  if (names.size() != axes.size())
    gap.what = (gap.several ? std::to_string(axes.size()) + " directions" : "one direction") + " of the " + half;
  else
    gap.what = gap.names_sensor ? FrameResultOf(List(names), reference->sensor) : List(names);
}

std::optional<CheckGap> GapOf(const Edge& edge, int first, const Weak& weak, const Half& by_edge,
                              const GraphSolution& solution, const Policy& policy) {
  const std::vector<Eigen::Vector3d> told = weak.ToldBy(by_edge);
  if (told.empty()) return std::nullopt;
  const auto T_ref_b = PlaceOf(edge.frame_b, solution);
  std::vector<AxisResult> axes = AxesAlong(told, first, T_ref_b, solution);
  const auto spared = [&](const AxisResult& axis) { return !IsNeededOf(edge, axis, solution, policy); };
  axes.erase(std::remove_if(axes.begin(), axes.end(), spared), axes.end());
  if (axes.empty()) return std::nullopt;
  CheckGap gap;
  gap.edge = &edge;
  gap.is_position = first == tangent::kTranslation;
  NameGap(axes, solution, gap);
  for (const AxisResult& axis : axes)
    gap.times_tolerance =
        std::max(gap.times_tolerance, weak.Sigma(T_ref_b.value_or(Se3()).R().transpose() * axis.direction));
  return gap;
}

}  // namespace

bool CheckGap::by_nothing() const { return std::isinf(times_tolerance); }

std::vector<CheckGap> GapsOf(const Edge& edge, const Matrix6d& by_others, const GraphSolution& solution,
                             const Policy& policy) {
  const PoseLimit tolerance = LimitsOfEdge(policy, edge).tolerance;
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(tolerance.m), Eigen::Vector3d::Constant(tolerance.rad);
  const Matrix6d own = unit.asDiagonal() * edge.uncertainty.Omega * unit.asDiagonal();
  const Matrix6d others = unit.asDiagonal() * by_others * unit.asDiagonal();
  std::vector<CheckGap> gaps;
  for (const int first : {tangent::kTranslation, tangent::kRotation}) {
    const int rest = tangent::kTranslation + tangent::kRotation - first;
    const Half by_edge = Alone(own, first, rest);
    for (const Weak& weak : WeakOf(Alone(others, first, rest)))
      if (auto gap = GapOf(edge, first, weak, by_edge, solution, policy)) gaps.push_back(*std::move(gap));
  }
  return gaps;
}

}  // namespace rigcal::fleet
