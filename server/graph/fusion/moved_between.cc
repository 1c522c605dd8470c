#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/graph/fusion/session_fusion.h"
#include "server/math/covariance.h"
#include "server/math/statistics.h"
#include "server/math/tangent.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMovesMax = 4, kScatterRounds = 10;
constexpr std::size_t kVisitsCompared = 8;
// A mount that scatters by more from visit to visit, along each axis, is loose.
constexpr double kSoundMount_m = 7.5e-4, kSoundMount_rad = 7.5e-4;

// Sessions on one side of a change, fused.
struct Side {
  SessionFusion fusion;
  MatrixXd covariance;  // of its poses
};
struct Sides {
  Side before, after;
  int visits = 0;
};

std::map<SensorId, std::vector<VisitResidual>> ResidualsWithin(const Sides& sides) {
  std::map<SensorId, std::vector<VisitResidual>> visits;
  for (const SessionFusion* side : {&sides.before.fusion, &sides.after.fusion}) {
    const auto residuals = ResidualsOfVisits(*side);
    for (std::size_t s = 0; s < residuals.size(); ++s)
      visits[side->sensors[s]].insert(visits[side->sensors[s]].end(), residuals[s].begin(), residuals[s].end());
  }
  return visits;
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
        if (const VisitVariance scatter = BetweenVisits(visits[side->sensors[s]], 2); scatter != side->scatter[s])
          side->scatter[s] = scatter, changed = true;
    if (!changed) return true;
  }
  return true;
}

// What both sides say of the sensors that both tell.
struct Difference {
  std::vector<SensorId> sensors;
  std::vector<Se3> T_before;
  VectorXd d;
  MatrixXd S;
};
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

struct Change {
  SensorId sensor;
  Vector6d step = Vector6d::Zero();
  Matrix6d covariance = Matrix6d::Zero();
  double gain = 0.0;
};

// A step of one sensor, E its columns: d = E step.
Change ChangeBy(const SensorId& sensor, const MatrixXd& E, const VectorXd& d, const MatrixXd& W) {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> half = E.transpose() * W;
  const Matrix6d information = half * E;
  const Eigen::LDLT<Matrix6d> ldlt(information);
  Change change{sensor, ldlt.solve(half * d), ldlt.solve(Matrix6d::Identity()), 0.0};
  change.gain = (half * d).dot(change.step);
  return change;
}

// Columns: a step of the reference, T_before = X T_after.
MatrixXd ByReference(const Difference& difference) {
  MatrixXd by_reference(difference.d.size(), 6);
  for (std::size_t s = 0; s < difference.sensors.size(); ++s)
    by_reference.middleRows<6>(static_cast<Eigen::Index>(6 * s)) = -Adjoint(difference.T_before[s].Inverse());
  return by_reference;
}

Change LikeliestChange(const Difference& difference, const SensorId& reference) {
  const Eigen::Index rows = difference.d.size();
  const VectorXd scale = difference.S.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd inverse =
      (scale.asDiagonal() * difference.S * scale.asDiagonal()).llt().solve(MatrixXd::Identity(rows, rows));
  const MatrixXd W = scale.asDiagonal() * inverse * scale.asDiagonal();
  Change best;
  for (std::size_t s = 0; s < difference.sensors.size(); ++s) {
    MatrixXd E = MatrixXd::Zero(rows, 6);
    E.middleRows<6>(static_cast<Eigen::Index>(6 * s)).setIdentity();
    const Change change = ChangeBy(difference.sensors[s], E, difference.d, W);
    if (change.gain > best.gain) best = change;
  }
  // Of two sensors nobody can tell which one was moved: the one that is not the reference is named.
  if (difference.sensors.size() < 2) return best;
  const Change change = ChangeBy(reference, ByReference(difference), difference.d, W);
  return change.gain > best.gain ? change : best;
}

// By chance alone, at most: of a gain over six numbers under the scatter that visits have within the sides.
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

// Both sides under a scatter that is taken as known: what a sound mount may scatter by, of the reference too, or all
// that a sensor's visits show, as if along one axis and the more so the fewer they are, where that is more.
std::optional<Difference> DifferenceOfSoundMounts(Sides sides) {
  constexpr double kAxes = 3.0;
  const double at_most = kAxes * (1.0 + 1.0 / std::max(1, sides.visits - 2));
  for (Side* side : {&sides.before, &sides.after}) {
    for (VisitVariance& scatter : side->fusion.scatter)
      scatter = {std::max(kSoundMount_m * kSoundMount_m, at_most * scatter.translation_m2),
                 std::max(kSoundMount_rad * kSoundMount_rad, at_most * scatter.rotation_rad2)};
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

struct Found {
  SensorMovedBetween moved;
  Matrix6d covariance = Matrix6d::Zero();
  double gain = 0.0;
  std::size_t first_after = 0;
};

bool IsMove(const Found& found) {
  return rigcal::IsMove(found.moved.step, Observable(found.covariance).covariance, found.moved.odds);
}

// Of `looks` such, each as likely by chance as `tail`.
Found FoundBy(const Change& change, const std::vector<SessionEstimate>& oldest_first, std::size_t first_after,
              double tail, double looks) {
  return {{change.sensor, oldest_first[first_after - 1].session, oldest_first[first_after].session, change.step,
           std::min(1.0, looks * tail)},
          change.covariance,
          change.gain,
          first_after};
}

// What all sessions before an element of `oldest_first` and from it on say, where they say anything of each other.
struct BothSides {
  Sides sides;
  Difference difference;
  double looks = 0.0;
};
std::optional<BothSides> SidesAbout(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                    std::size_t first_after, const SensorsOfSessions& left_out) {
  const auto middle = oldest_first.begin() + static_cast<std::ptrdiff_t>(first_after);
  Sides sides{{FusionOf(input, {oldest_first.begin(), middle}, false, left_out), {}},
              {FusionOf(input, {middle, oldest_first.end()}, false, left_out), {}},
              static_cast<int>(oldest_first.size())};
  if (sides.before.fusion.factors.empty() || sides.after.fusion.factors.empty() || !SettleSides(sides))
    return std::nullopt;
  Difference difference = DifferenceOf(sides);
  if (difference.sensors.empty()) return std::nullopt;
  const double looks = static_cast<double>((difference.sensors.size() + 1) * (oldest_first.size() - 1));
  return BothSides{std::move(sides), std::move(difference), looks};
}

// By the scatter that the sessions themselves show, of two none.
std::optional<Found> ShownBefore(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                 std::size_t first_after, const SensorsOfSessions& left_out) {
  const auto both = SidesAbout(input, oldest_first, first_after, left_out);
  if (!both) return std::nullopt;
  const Change change = LikeliestChange(both->difference, input.reference);
  return FoundBy(change, oldest_first, first_after, TailOf(both->sides, change.gain), both->looks);
}

// `oldest_first`; the change is before its element `first_after`.
std::optional<Found> ChangeBefore(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                  std::size_t first_after, const SensorsOfSessions& left_out) {
  const auto found = ShownBefore(input, oldest_first, first_after, left_out);
  const bool tells_scatter = oldest_first.size() > 2;
  if (!found || IsMove(*found) == tells_scatter) return found;
  // Of two visits nothing tells what a sensor scatters by, few tell little of it, and no F of few degrees of freedom is
  // ever unlikely. What the two about the change say by themselves stands unless the scatter of a sound mount explains
  // it.
  const std::vector<SessionEstimate> two = {oldest_first[first_after - 1], oldest_first[first_after]};
  const auto by_two = ShownBefore(input, two, 1, left_out);
  if (!by_two || !IsMove(*by_two)) return found;
  const auto both = SidesAbout(input, oldest_first, first_after, left_out);
  const auto of_sound = both ? DifferenceOfSoundMounts(both->sides) : std::nullopt;
  if (!of_sound) return found;
  const Change large = LikeliestChange(*of_sound, input.reference);
  return FoundBy(large, oldest_first, first_after, ChiSquareTail(large.gain, 6), both->looks);
}

std::optional<Found> LikeliestOf(const FusionInput& input, const std::vector<SessionEstimate>& oldest_first,
                                 const SensorsOfSessions& left_out) {
  std::optional<Found> best;
  for (std::size_t k = 1; k < oldest_first.size(); ++k) {
    auto found = ChangeBefore(input, oldest_first, k, left_out);
    if (found && IsMove(*found) &&
        (!best || found->moved.odds < best->moved.odds ||
         (found->moved.odds == best->moved.odds && found->gain > best->gain)))
      best = std::move(found);
  }
  return best;
}

}  // namespace

std::vector<SensorMovedBetween> FindMovesBetween(const FusionInput& input,
                                                 const std::vector<SessionEstimate>& estimates) {
  std::vector<SessionEstimate> oldest_first;
  for (const SessionEstimate& estimate : estimates)
    if (oldest_first.size() < kVisitsCompared && IsFused(estimate, input)) oldest_first.push_back(estimate);
  std::reverse(oldest_first.begin(), oldest_first.end());
  std::vector<SensorMovedBetween> moves;
  SensorsOfSessions left_out;
  while (static_cast<int>(moves.size()) < kMovesMax) {
    const auto found = LikeliestOf(input, oldest_first, left_out);
    if (!found) break;
    moves.push_back(found->moved);
    for (std::size_t k = 0; k < found->first_after; ++k)
      left_out.insert({oldest_first[k].session, found->moved.sensor});
  }
  return moves;
}

}  // namespace rigcal::graph
