#include "server/graph/fusion/visit_sides.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "server/math/statistics.h"
#include "server/math/tangent.h"
#include "server/model/graph/connected.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kScatterRounds = 10;
constexpr double kScatterSettled = 1e-4;
// A mount that scatters by more from visit to visit, along each axis, is loose.
constexpr double kSoundMount_m = 7.5e-4, kSoundMount_rad = 7.5e-4;

std::map<SensorId, std::vector<VisitResidual>> ResidualsWithin(const Sides& sides) {
  std::map<SensorId, std::vector<VisitResidual>> visits;
  for (const SessionFusion* side : {&sides.before.fusion, &sides.after.fusion}) {
    const auto residuals = ResidualsOfVisits(*side);
    for (std::size_t s = 0; s < residuals.size(); ++s)
      visits[side->sensors[s]].insert(visits[side->sensors[s]].end(), residuals[s].begin(), residuals[s].end());
  }
  return visits;
}

bool IsSettled(const VisitVariance& scatter, const VisitVariance& before) {
  const auto close = [](double a, double b) { return std::abs(a - b) <= kScatterSettled * std::max(a, b); };
  return close(scatter.translation_m2, before.translation_m2) && close(scatter.rotation_rad2, before.rotation_rad2);
}

// Both sides settled, with one scatter per sensor from the residuals within the sides.
bool SettleSides(Sides& sides) {
  for (int round = 0; round < kScatterRounds; ++round) {
    auto before = Settle(sides.before.fusion), after = Settle(sides.after.fusion);
    if (!before || !after) return false;
    sides.before.covariance = std::move(*before);
    sides.after.covariance = std::move(*after);
    if (sides.visits <= 2) return true;
    auto visits = ResidualsWithin(sides);
    bool changed = false;
    for (SessionFusion* side : {&sides.before.fusion, &sides.after.fusion})
      for (std::size_t s = 0; s < side->sensors.size(); ++s)
        if (const VisitVariance scatter = BetweenVisits(visits[side->sensors[s]], {2.0, 2.0});
            !IsSettled(scatter, side->scatter[s]))
          side->scatter[s] = scatter, changed = true;
    if (!changed) return true;
  }
  return true;
}

Difference DifferenceOf(const Sides& sides) {
  Difference difference;
  std::vector<int> before, after;
  for (std::size_t s = 0; s < sides.before.fusion.sensors.size(); ++s) {
    const auto& sensors = sides.after.fusion.sensors;
    const auto found = std::find(sensors.begin(), sensors.end(), sides.before.fusion.sensors[s]);
    if (found == sensors.end()) continue;
    difference.sensors.push_back(*found);
    difference.T_before.push_back(sides.before.fusion.T_ref[s]);
    for (int i = 0; i < 6; ++i) {
      before.push_back(static_cast<int>(6 * s) + i);
      after.push_back(static_cast<int>(6 * (found - sensors.begin())) + i);
    }
  }
  difference.d.resize(static_cast<Eigen::Index>(before.size()));
  for (std::size_t s = 0; s < difference.sensors.size(); ++s)
    difference.d.segment<6>(static_cast<Eigen::Index>(6 * s)) =
        (difference.T_before[s].Inverse() * sides.after.fusion.T_ref[static_cast<std::size_t>(after[6 * s] / 6)]).Log();
  difference.S = sides.before.covariance(before, before) + sides.after.covariance(after, after);
  return difference;
}

// A step by which d = E step; `half`: E^T W, `information`: E^T W E.
Change ChangeBy(const SensorId& sensor, const Eigen::Matrix<double, 6, Eigen::Dynamic>& half,
                const Matrix6d& information, const VectorXd& d) {
  const Eigen::LDLT<Matrix6d> ldlt(information);
  Change change{sensor, ldlt.solve(half * d), ldlt.solve(Matrix6d::Identity()), 0.0};
  change.gain = (half * d).dot(change.step);
  return change;
}

// Of the visits from `first` up to before `end`.
std::vector<SessionEstimate> TiedToReference(const Visits& visits, std::size_t first, std::size_t end,
                                             const SensorId& reference) {
  const auto told = visits.told.begin();
  std::set<SensorId> tied;
  for (const std::set<SensorId>& sensors :
       Connected({told + static_cast<std::ptrdiff_t>(first), told + static_cast<std::ptrdiff_t>(end)}))
    if (sensors.contains(reference)) tied = sensors;
  std::vector<SessionEstimate> side;
  for (std::size_t k = first; k < end; ++k)
    if (!visits.told[k].empty() && tied.contains(*visits.told[k].begin())) side.push_back(visits.sessions[k]);
  return side;
}

}  // namespace

MatrixXd ByReference(const Difference& difference) {
  MatrixXd by_reference(difference.d.size(), 6);
  for (std::size_t s = 0; s < difference.sensors.size(); ++s)
    by_reference.middleRows<6>(static_cast<Eigen::Index>(6 * s)) = -Adjoint(difference.T_before[s].Inverse());
  return by_reference;
}

std::vector<Change> ChangesOf(const Difference& difference, const SensorId& reference) {
  const Eigen::Index rows = difference.d.size();
  const VectorXd scale = difference.S.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd inverse =
      (scale.asDiagonal() * difference.S * scale.asDiagonal()).llt().solve(MatrixXd::Identity(rows, rows));
  const MatrixXd W = scale.asDiagonal() * inverse * scale.asDiagonal();
  std::vector<Change> changes;
  for (std::size_t s = 0; s < difference.sensors.size(); ++s) {
    const auto row = static_cast<Eigen::Index>(6 * s);
    changes.push_back(ChangeBy(difference.sensors[s], W.middleRows<6>(row), W.block<6, 6>(row, row), difference.d));
  }
  // Of two sensors nobody can tell which one was moved: the one that is not the reference is named.
  if (difference.sensors.size() < 2) return changes;
  const MatrixXd E = ByReference(difference);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> half = E.transpose() * W;
  changes.push_back(ChangeBy(reference, half, half * E, difference.d));
  return changes;
}

Change LikeliestChange(const Difference& difference, const SensorId& reference) {
  Change best;
  for (const Change& change : ChangesOf(difference, reference))
    if (change.gain > best.gain) best = change;
  return best;
}

double TailOf(const Sides& sides, double gain) {
  double numbers = 6.0, dof = std::numeric_limits<double>::infinity();
  auto visits = ResidualsWithin(sides);
  for (const SessionFusion* side : {&sides.before.fusion, &sides.after.fusion})
    for (std::size_t s = 0; s < side->sensors.size(); ++s) {
      const VisitVariance& scatter = side->scatter[s];
      double of_sensor = 0.0;
      for (const auto& [part, variance] : {std::pair{tangent::kTranslation, scatter.translation_m2},
                                           std::pair{tangent::kRotation, scatter.rotation_rad2}}) {
        const double axes = variance > 0 ? AxesThatScatter(visits[side->sensors[s]], part, variance, 2) : 3.0;
        of_sensor += axes;
        if (variance > 0) dof = std::min(dof, axes * (static_cast<double>(visits[side->sensors[s]].size()) - 2));
      }
      numbers = std::min(numbers, of_sensor);
    }
  return std::isfinite(dof) ? FisherTail(gain / 6, numbers, dof) : ChiSquareTail(gain, 6);
}

std::optional<Difference> DifferenceOfSoundMounts(Sides sides) {
  constexpr double kAxes = 3.0;
  auto visits = ResidualsWithin(sides);
  for (Side* side : {&sides.before, &sides.after}) {
    for (std::size_t s = 0; s < side->fusion.sensors.size(); ++s) {
      VisitVariance& scatter = side->fusion.scatter[s];
      const auto beyond_means = static_cast<double>(visits[side->fusion.sensors[s]].size()) - 2;
      const double at_most = kAxes * (1.0 + 1.0 / std::max(1.0, beyond_means));
      scatter = {std::max(kSoundMount_m * kSoundMount_m, at_most * scatter.translation_m2),
                 std::max(kSoundMount_rad * kSoundMount_rad, at_most * scatter.rotation_rad2)};
    }
    auto covariance = Settle(side->fusion);
    if (!covariance) return std::nullopt;
    side->covariance = std::move(*covariance);
  }
  Difference difference = DifferenceOf(sides);
  const MatrixXd by_reference = ByReference(difference);
  const VisitVariance sound{kSoundMount_m * kSoundMount_m, kSoundMount_rad * kSoundMount_rad};
  const double of_means = 1.0 / static_cast<double>(sides.before.fusion.factors.size()) +
                          1.0 / static_cast<double>(sides.after.fusion.factors.size());
  difference.S += of_means * by_reference * sound.Matrix() * by_reference.transpose();
  return difference;
}

std::optional<BothSides> SidesAbout(const FusionInput& input, const Visits& visits, std::size_t first_after,
                                    const SensorsOfSessions& left_out) {
  const auto before = TiedToReference(visits, 0, first_after, input.reference),
             after = TiedToReference(visits, first_after, visits.sessions.size(), input.reference);
  Sides sides{{FusionOf(input, before, false, left_out), {}},
              {FusionOf(input, after, false, left_out), {}},
              static_cast<int>(before.size() + after.size())};
  if (sides.before.fusion.factors.empty() || sides.after.fusion.factors.empty() || !SettleSides(sides))
    return std::nullopt;
  Difference difference = DifferenceOf(sides);
  if (difference.sensors.empty()) return std::nullopt;
  const auto sensors_asked = static_cast<double>(difference.sensors.size() + 1);
  return BothSides{std::move(sides), std::move(difference), sensors_asked};
}

GraphSolution InFrameOf(const SensorId& frame, const GraphSolution& solution) {
  Se3 T_ref_frame;
  for (const SensorPose& pose : solution.poses)
    if (pose.sensor == frame) T_ref_frame = pose.T_ref_sensor;
  GraphSolution in_frame;
  for (const SensorPose& pose : solution.poses) {
    if (!pose.known) continue;
    SensorPose& one = in_frame.poses.emplace_back();
    one.sensor = pose.sensor;
    one.known = true;
    one.T_ref_sensor = T_ref_frame.Inverse() * pose.T_ref_sensor;
  }
  return in_frame;
}

std::set<SensorId> SensorsTold(const FusionInput& input, const SessionEstimate& estimate,
                               const SensorsOfSessions& left_out) {
  const SessionFusion fusion = FusionOf(input, {estimate}, false, left_out);
  std::set<SensorId> told(fusion.sensors.begin(), fusion.sensors.end());
  if (fusion.factors.empty()) return told;
  const SessionFactor& factor = fusion.factors.front();
  const bool is_row = std::find(factor.variable.begin(), factor.variable.end(), kFixed) != factor.variable.end();
  if (factor.frame == kFixed || is_row) told.insert(input.reference);
  return told;
}

}  // namespace rigcal::graph
