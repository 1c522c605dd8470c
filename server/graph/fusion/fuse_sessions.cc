#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "server/graph/fusion/random_walk.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/math/covariance.h"
#include "server/math/pooled_dof.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kScatterRoundsMax = 30;
constexpr double kScatterSettled = 0.01;
// A variance alike along three axes, from n numbers, twice, or six variances, each from n: as sure as a 6 x 6
// covariance of so many times n degrees of freedom (the same expected error in PooledDof's measure: of 3 numbers 42 /
// 4).
constexpr double kMatrixDofPerNumber = 10.0 / 3.0;

// Per sensor, what visits say beside where it was on each.
std::vector<AboutWalk> AboutWalks(const SessionFusion& fusion) {
  std::vector<AboutWalk> about;
  for (auto& visits : ResidualsOfVisits(fusion)) {
    const std::size_t s = about.size();
    about.push_back(LessWalk(std::move(visits), fusion.walk[s], fusion.scatter[s]));
  }
  return about;
}

std::vector<VisitVariance> ScatterOf(const SessionFusion& fusion) {
  std::vector<VisitVariance> scatter;
  for (const AboutWalk& about : AboutWalks(fusion)) scatter.push_back(BetweenVisits(about.visits, about.means));
  return scatter;
}

bool Same(const std::vector<VisitVariance>& x, const std::vector<VisitVariance>& y) {
  const auto close = [](double a, double b) { return std::abs(a - b) <= kScatterSettled * std::max(a, b); };
  return std::equal(x.begin(), x.end(), y.begin(), [&](const VisitVariance& a, const VisitVariance& b) {
    return close(a.translation_m2, b.translation_m2) && close(a.rotation_rad2, b.rotation_rad2);
  });
}

// Weights and scatter in turn: how visits are weighed depends on how they scatter.
std::optional<MatrixXd> SettleWithScatter(SessionFusion& fusion) {
  auto inverse = Settle(fusion);
  for (int round = 0; inverse && round < kScatterRoundsMax; ++round) {
    const std::vector<VisitVariance> scatter = ScatterOf(fusion);
    if (Same(scatter, fusion.scatter)) break;
    fusion.scatter = scatter;
    inverse = Settle(fusion);
  }
  return inverse;
}

// Symmetric root of a covariance of mixed units: with alike sources and alike geometry it is alike on every visit.
MatrixXd RootOf(const MatrixXd& C) {
  const VectorXd scale = C.diagonal().unaryExpr([](double c) { return c > 0 ? std::sqrt(c) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<MatrixXd> axes(scale.cwiseInverse().asDiagonal() * C *
                                                     scale.cwiseInverse().asDiagonal());
  return scale.asDiagonal() * axes.eigenvectors() * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         axes.eigenvectors().transpose();
}

// Per sensor: what its own visits scatter by, and what is taken for it.
struct Scatters {
  std::vector<ScatterDof> walk_dof;
  std::vector<VisitScatter> shown;
  std::vector<std::optional<VisitScatter>> pooled;
  std::vector<ScatterDof> dof;
};

std::optional<ScatterOfAxes> Part(const std::optional<VisitScatter>& scatter, ScatterOfAxes VisitScatter::*axes) {
  return scatter ? std::optional((*scatter).*axes) : std::nullopt;
}

VisitVariance VarianceTaken(const ScatterTaken& translation, const ScatterTaken& rotation) {
  VisitVariance variance{translation.variance, rotation.variance};
  if (!translation.AxesAreAlike() || !rotation.AxesAreAlike()) variance.by_axis = AlongAxes(translation, rotation);
  return variance;
}

// Of a sensor that visits tell others against, and none tells itself (an island's reference), nobody knows what of the
// others' scatter is its own: all of the largest may be.
void TakeScatterOfMembers(SessionFusion& fusion, Scatters& scatters) {
  const auto size = [&](int s) {
    const VisitVariance& variance = fusion.scatter[static_cast<std::size_t>(s)];
    return variance.translation_m2 + variance.rotation_rad2;
  };
  for (int s = 0; s < static_cast<int>(fusion.sensors.size()); ++s) {
    int largest = kFixed;
    bool is_told = false;
    for (const SessionFactor& factor : fusion.factors) {
      is_told |= std::find(factor.variable.begin(), factor.variable.end(), s) != factor.variable.end();
      for (const int member : factor.variable)
        if (factor.frame == s && member != kFixed && (largest == kFixed || size(member) > size(largest)))
          largest = member;
    }
    if (is_told || largest == kFixed) continue;
    const auto to = static_cast<std::size_t>(s), from = static_cast<std::size_t>(largest);
    fusion.scatter[to] = {fusion.scatter[from].translation_m2, fusion.scatter[from].rotation_rad2};
    scatters.dof[to] = scatters.dof[from];
  }
}

// What the robot's own visits show stays as it was without the pool, which others learn from in turn.
Scatters TakeScatter(const PooledScatter& pooled, std::vector<ScatterDof> walk_dof, SessionFusion& fusion) {
  Scatters scatters;
  scatters.walk_dof = std::move(walk_dof);
  std::vector<ScatterOfAxes> translations, rotations;  // of all sensors
  for (const AboutWalk& about : AboutWalks(fusion)) {
    scatters.shown.push_back(ScatterShown(about.visits, about.means));
    translations.push_back(scatters.shown.back().translation);
    rotations.push_back(scatters.shown.back().rotation);
  }
  for (std::size_t s = 0; s < fusion.sensors.size(); ++s) {
    const auto found = pooled.find(fusion.sensors[s]);
    const std::optional<VisitScatter> of_others = found == pooled.end() ? std::nullopt : std::optional(found->second);
    const ScatterTaken translation =
                           TakenScatter(translations[s], Part(of_others, &VisitScatter::translation), translations),
                       rotation = TakenScatter(rotations[s], Part(of_others, &VisitScatter::rotation), rotations);
    scatters.pooled.push_back(of_others);
    scatters.dof.push_back({translation.dof, rotation.dof});
    fusion.scatter[s] = VarianceTaken(translation, rotation);
  }
  TakeScatterOfMembers(fusion, scatters);
  return scatters;
}

// `estimates` and so the factors: the newest first.
void TakeAges(const std::map<SessionId, Stamp>& captured_at, SessionFusion& fusion) {
  constexpr double kDay_ns = 86'400e9;
  std::optional<Stamp> newest;
  double age_days = 0.0;  // of the session before, where it is not told
  for (SessionFactor& factor : fusion.factors) {
    if (const auto at = captured_at.find(factor.session); at != captured_at.end()) {
      if (!newest) newest = at->second;
      age_days = std::max(age_days, static_cast<double>(newest->ns - at->second.ns) / kDay_ns);
    }
    factor.age_days = age_days;
  }
}

// Into the fusion; what stands behind that comes back.
std::vector<ScatterDof> TakeWalks(SessionFusion& fusion) {
  std::vector<ScatterDof> dof;
  for (const auto& visits : ResidualsOfVisits(fusion)) {
    const Walk walk = WalkOf(visits);
    fusion.walk[dof.size()] = walk.per_day;
    dof.push_back(walk.dof);
  }
  return dof;
}

// On average: a sensor walks on until the next.
double DaysBetweenVisits(const SessionFusion& fusion) {
  const auto visits = static_cast<double>(fusion.sessions.size());
  return visits > 1 ? fusion.factors.back().age_days / (visits - 1) : 0.0;
}

struct Told {
  MatrixXd covariance;      // of a visit's poses, rows of the sensors
  std::vector<double> dof;  // per sensor
};

// `gains` of GainsOf.
MatrixXd CommonPart(const SessionFusion& fusion, const std::vector<MatrixXd>& gains) {
  const Eigen::Index size = fusion.Size();
  MatrixXd moved =
      MatrixXd::Zero(size, size + 6);  // by what is common, a source per row of a sensor; the last: the reference
  MatrixXd counted = MatrixXd::Zero(size, size);  // of it in `inverse` already, as if visits erred apart
  for (std::size_t k = 0; k < fusion.factors.size(); ++k) {
    const SessionFactor& factor = fusion.factors[k];
    if (factor.common.rows() == 0) continue;
    const MatrixXd& G = gains[k];
    const MatrixXd by = G * RootOf(factor.common);
    counted += G * factor.common * G.transpose();
    for (std::size_t i = 0; i < factor.variable.size(); ++i)
      moved.middleCols<6>(factor.variable[i] == kFixed ? size : 6 * factor.variable[i]) +=
          by.middleCols<6>(6 * static_cast<Eigen::Index>(i));
  }
  return moved * moved.transpose() - counted;
}

// Of a robot alone: what visits show is what they scatter by and what they err by, and the second was taken off.
double DofOfBetween(double dof, double variance, const ScatterOfAxes& shown) {
  const double both = variance + shown.own;
  return both > 0 ? dof * std::pow(variance / both, 2) : dof;
}

ScatterDof DofOfTaken(const SessionFusion& fusion, const Scatters& scatters, std::size_t sensor) {
  const ScatterDof& dof = scatters.dof[sensor];
  if (scatters.pooled[sensor] || !(dof.translation > 0)) return dof;
  const VisitScatter& shown = scatters.shown[sensor];
  const auto least_one = [](double of_between) { return std::max(1.0, of_between); };
  return {least_one(DofOfBetween(dof.translation, fusion.scatter[sensor].translation_m2, shown.translation)),
          least_one(DofOfBetween(dof.rotation, fusion.scatter[sensor].rotation_rad2, shown.rotation))};
}

int AsMatrixDof(double numbers) { return static_cast<int>(std::lround(std::min(1e6, kMatrixDofPerNumber * numbers))); }

// Of one sensor, rows `row` on of `told`, which lacks the scatter of the next visit.
struct ToldPart {
  std::size_t sensor = 0;
  Eigen::Index row = 0;
  Matrix6d covariance, by_next_walk;
};

double DofOf(const SessionFusion& fusion, const std::vector<MatrixXd>& gains, const MatrixXd& inverse,
             const ToldPart& part, const Scatters& scatters) {
  PooledDof pooled(part.covariance);
  Matrix6d by_walk = inverse.block<6, 6>(part.row, part.row) + part.by_next_walk;  // what the visits do not make up
  for (std::size_t k = 0; k < fusion.factors.size(); ++k) {
    const SessionFactor& factor = fusion.factors[k];
    const MatrixXd G = gains[k].middleRows<6>(part.row);
    double dof = *std::min_element(factor.dof.begin(), factor.dof.end());
    for (std::size_t i = 0; i < factor.variable.size(); ++i)
      if (factor.variable[i] == static_cast<int>(part.sensor)) dof = factor.dof[i];
    pooled.Add(G * factor.C * G.transpose(), static_cast<int>(std::lround(dof)));
    by_walk -= G * WithScatter(fusion, factor) * G.transpose();
  }
  const ScatterDof of_scatter = DofOfTaken(fusion, scatters, part.sensor), of_walk = scatters.walk_dof[part.sensor];
  if (const double least = std::min(of_scatter.translation, of_scatter.rotation); least > 0)
    pooled.Add(fusion.scatter[part.sensor].Matrix(), AsMatrixDof(least));
  if (const double least = std::min(of_walk.translation, of_walk.rotation); least > 0)
    pooled.Add(by_walk, AsMatrixDof(least));
  return pooled.Of(part.covariance);
}

Told ToldOf(const SessionFusion& fusion, const MatrixXd& inverse, const Scatters& scatters) {
  const auto rows = 6 * static_cast<Eigen::Index>(fusion.sensors.size());
  const std::vector<MatrixXd> gains = GainsOf(fusion, inverse);
  Told told{(inverse + CommonPart(fusion, gains)).topLeftCorner(rows, rows), {}};
  const double between_days = DaysBetweenVisits(fusion);
  for (std::size_t s = 0; s < fusion.sensors.size(); ++s) {
    const auto row = 6 * static_cast<Eigen::Index>(s);
    const Matrix6d next_walk = between_days * fusion.walk[s].Matrix();
    told.covariance.block<6, 6>(row, row) += fusion.scatter[s].Matrix() + next_walk;
    told.dof.push_back(
        DofOf(fusion, gains, inverse, {s, row, told.covariance.block<6, 6>(row, row), next_walk}, scatters));
  }
  return told;
}

int SessionsOf(const SessionFusion& fusion, int variable) {
  return static_cast<int>(std::count_if(fusion.factors.begin(), fusion.factors.end(), [&](const SessionFactor& factor) {
    return factor.frame == variable ||
           std::find(factor.variable.begin(), factor.variable.end(), variable) != factor.variable.end();
  }));
}

// Against another sensor than the robot's reference: what it scatters by is not what other robots' does.
bool IsToldInAnIsland(const SessionFusion& fusion, int variable) {
  return std::any_of(fusion.factors.begin(), fusion.factors.end(), [&](const SessionFactor& factor) {
    const bool is_island = factor.frame != kFixed && factor.frame < static_cast<int>(fusion.sensors.size());
    return is_island && (factor.frame == variable ||
                         std::find(factor.variable.begin(), factor.variable.end(), variable) != factor.variable.end());
  });
}

void TakePoses(const SessionFusion& fusion, const Told& told, const Scatters& scatters, GraphSolution& solution) {
  for (SensorPose& pose : solution.poses) {
    const auto found = std::find(fusion.sensors.begin(), fusion.sensors.end(), pose.sensor);
    if (found == fusion.sensors.end()) continue;
    const auto s = static_cast<std::size_t>(found - fusion.sensors.begin());
    const VisitVariance& scatter = fusion.scatter[s];
    pose.fused = FusedPose{pose.T_ref_sensor,
                           pose.covariance,
                           SessionsOf(fusion, static_cast<int>(s)),
                           std::sqrt(scatter.translation_m2),
                           std::sqrt(scatter.rotation_rad2),
                           IsToldInAnIsland(fusion, static_cast<int>(s)) ? VisitScatter{} : scatters.shown[s],
                           scatters.pooled[s],
                           scatters.dof[s],
                           scatter.by_axis,
                           std::sqrt(fusion.walk[s].translation_m2),
                           std::sqrt(fusion.walk[s].rotation_rad2)};
    const auto row = 6 * static_cast<Eigen::Index>(s);
    pose.T_ref_sensor = fusion.T_ref[s];
    pose.covariance = Symmetrized(told.covariance.block<6, 6>(row, row));
    pose.dof = told.dof[s];
  }
}

std::vector<FusedSessions::HeldBack> HeldBackIn(const std::vector<SessionEstimate>& estimates,
                                                const std::vector<SessionId>& sessions) {
  std::vector<FusedSessions::HeldBack> held_back;
  for (const SessionEstimate& estimate : estimates)
    if (std::find(sessions.begin(), sessions.end(), estimate.session) != sessions.end())
      for (const HeldBackLook& look : estimate.held_back)
        held_back.push_back({estimate.session, look.sensor, look.capture, look.against, look.why});
  return held_back;
}

// `estimates`: the newest first.
std::vector<FusedSessions::ClockOfSession> ClocksIn(const std::vector<SessionEstimate>& estimates,
                                                    const std::vector<SessionId>& sessions) {
  std::map<SensorId, FusedSessions::ClockOfSession> newest;
  for (const SessionEstimate& estimate : estimates)
    if (std::find(sessions.begin(), sessions.end(), estimate.session) != sessions.end())
      for (const TrackerClock& clock : estimate.clocks)
        newest.try_emplace(clock.tracker, FusedSessions::ClockOfSession{estimate.session, clock});
  std::vector<FusedSessions::ClockOfSession> clocks;
  for (const auto& [tracker, clock] : newest) clocks.push_back(clock);
  return clocks;
}

// `estimates`: the newest first.
std::optional<FusedSessions::Influential> InfluentialIn(const std::vector<SessionEstimate>& estimates,
                                                        const SessionFusion& fusion) {
  const auto newest = std::find_if(estimates.begin(), estimates.end(), [&](const SessionEstimate& estimate) {
    return std::find(fusion.sessions.begin(), fusion.sessions.end(), estimate.session) != fusion.sessions.end();
  });
  std::optional<FusedSessions::Influential> most;
  if (newest == estimates.end()) return most;
  for (auto part = newest; part != estimates.end() && part->session == newest->session; ++part)  // its islands too
    for (const CaptureGroup& group : part->groups) {
      const bool counts = std::find(fusion.sensors.begin(), fusion.sensors.end(), group.sensor) != fusion.sensors.end();
      if (counts && (!most || group.sigmas > most->sigmas))
        most = {newest->session, group.captures, group.sensor, group.sigmas};
    }
  return most;
}

std::vector<std::string> MadeBy(const std::vector<SessionEstimate>& estimates, const std::vector<SessionId>& sessions) {
  std::vector<std::string> made_by;
  for (const SessionId& session : sessions)
    made_by.push_back(std::find_if(estimates.begin(), estimates.end(), [&](const SessionEstimate& estimate) {
                        return estimate.session == session;
                      })->made_by);
  const auto is_unknown = [](const std::string& name) { return name.empty(); };
  if (std::any_of(made_by.begin(), made_by.end(), is_unknown)) made_by.clear();
  return made_by;
}

std::vector<LensMisfit> LensesIn(std::vector<SessionEstimate> estimates, const std::vector<SessionId>& sessions) {
  std::erase_if(estimates, [&](const SessionEstimate& estimate) {
    return std::find(sessions.begin(), sessions.end(), estimate.session) == sessions.end();
  });
  std::vector<LensMisfit> lenses = NewestMisfits(estimates);
  std::sort(lenses.begin(), lenses.end(), [](const LensMisfit& x, const LensMisfit& y) { return x.camera < y.camera; });
  return lenses;
}

}  // namespace

void FuseSessions(const std::vector<Edge>& edges, const std::vector<Edge>& within, const SensorId& reference,
                  const std::vector<SessionEstimate>& estimates, GraphSolution& solution, const PooledScatter& pooled,
                  const std::map<SessionId, Stamp>& captured_at) {
  SessionFusion fusion = FusionOf({edges, within, reference, solution}, estimates, true);
  if (fusion.factors.empty() || fusion.sensors.size() > kFusedSensorsMax) return;
  TakeAges(captured_at, fusion);
  if (!SettleWithScatter(fusion)) return;
  std::vector<ScatterDof> walk_dof = TakeWalks(fusion);
  if (!SettleWithScatter(fusion)) return;
  const Scatters scatters = TakeScatter(pooled, std::move(walk_dof), fusion);
  const auto inverse = Settle(fusion);
  if (!inverse) return;
  MovesBetween moves = FindMovesBetween({edges, within, reference, solution}, estimates);
  solution.fused.moved = std::move(moves.moved);
  solution.fused.apart = std::move(moves.apart);
  const Told told = ToldOf(fusion, *inverse, scatters);
  TakePoses(fusion, told, scatters, solution);
  solution.fused.held_back = HeldBackIn(estimates, fusion.sessions);
  solution.fused.clocks = ClocksIn(estimates, fusion.sessions);
  solution.fused.influential = InfluentialIn(estimates, fusion);
  solution.fused.lenses = LensesIn(estimates, fusion.sessions);
  solution.fused.sessions = fusion.sessions;
  solution.fused.made_by = MadeBy(estimates, fusion.sessions);
  solution.fused.sensors = fusion.sensors;
  solution.fused.covariance = told.covariance;
}

}  // namespace rigcal::graph
