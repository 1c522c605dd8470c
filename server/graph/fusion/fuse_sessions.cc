#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "server/graph/fusion/next_visit.h"
#include "server/graph/fusion/random_walk.h"
#include "server/graph/fusion/session_fusion.h"
#include "server/graph/fusion/visit_ages.h"
#include "server/math/covariance.h"

namespace rigcal::graph {
namespace {

using Eigen::MatrixXd;

constexpr int kScatterRoundsMax = 30;
constexpr double kScatterSettled = 0.01;
constexpr std::size_t kWalkingSensorsMax = 60;  // of larger rigs nothing walks: an hour's work, and a gigabyte

// Per sensor, what visits say beside where it was on each.
std::vector<WalkResiduals> ResidualsAboutWalks(const SessionFusion& fusion) {
  std::vector<WalkResiduals> residuals;
  for (auto& visits : ResidualsOfVisits(fusion)) {
    const std::size_t s = residuals.size();
    residuals.push_back(ResidualsAboutWalk(std::move(visits), fusion.walk[s], fusion.scatter[s]));
  }
  return residuals;
}

std::vector<VisitVariance> ScatterOf(const SessionFusion& fusion) {
  std::vector<VisitVariance> scatter;
  for (const WalkResiduals& one : ResidualsAboutWalks(fusion)) scatter.push_back(BetweenVisits(one.visits, one.means));
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

// Per sensor: what its own visits scatter by, about one place and about where it was on each, and what is taken for it.
struct Scatters {
  std::vector<VisitScatter> about_place, about_walk;
  std::vector<std::optional<VisitScatter>> pooled;
  std::vector<ScatterDof> dof, walk_dof;
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
    fusion.walk[to] = fusion.walk[from];
    scatters.dof[to] = scatters.dof[from];
    scatters.walk_dof[to] = scatters.walk_dof[from];
  }
}

// Without a walk: what others learn from. A robot of few visits cannot tell the two apart, and has neither of its own.
std::vector<VisitScatter> ScattersAboutPlace(const SessionFusion& fusion) {
  std::vector<VisitScatter> scatters;
  for (const auto& visits : ResidualsOfVisits(fusion)) scatters.push_back(ScatterShown(visits));
  return scatters;
}

// What the robot's own visits show stays as it was without the pool, which others learn from in turn.
void TakeScatter(const PooledScatter& pooled, SessionFusion& fusion, Scatters& scatters) {
  std::vector<ScatterOfAxes> translations, rotations;  // of all sensors
  for (const WalkResiduals& one : ResidualsAboutWalks(fusion)) {
    scatters.about_walk.push_back(ScatterShown(one.visits, one.means));
    translations.push_back(scatters.about_walk.back().translation);
    rotations.push_back(scatters.about_walk.back().rotation);
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
}

// Into the fusion; what stands behind that comes back.
std::vector<ScatterDof> TakeWalks(SessionFusion& fusion) {
  std::vector<ScatterDof> dof(fusion.sensors.size());
  if (fusion.sensors.size() > kWalkingSensorsMax) return dof;
  const auto visits = ResidualsOfVisits(fusion);
  for (std::size_t s = 0; s < fusion.sensors.size(); ++s) {
    const Walk walk = WalkOf(visits[s]);
    fusion.walk[s] = walk.per_day;
    dof[s] = walk.dof;
  }
  return dof;
}

// Of a robot alone: what visits show is what they scatter by and what they err by, and the second was taken off.
double DofOfBetween(double dof, double variance, const ScatterOfAxes& shown) {
  const double both = variance + shown.own;
  return both > 0 ? dof * std::pow(variance / both, 2) : dof;
}

ScatterDof DofOfTaken(const SessionFusion& fusion, const Scatters& scatters, std::size_t sensor) {
  const ScatterDof& dof = scatters.dof[sensor];
  if (scatters.pooled[sensor] || !(dof.translation > 0)) return dof;
  const VisitScatter& shown = scatters.about_walk[sensor];
  const auto least_one = [](double of_between) { return std::max(1.0, of_between); };
  return {least_one(DofOfBetween(dof.translation, fusion.scatter[sensor].translation_m2, shown.translation)),
          least_one(DofOfBetween(dof.rotation, fusion.scatter[sensor].rotation_rad2, shown.rotation))};
}

FusionDof DofBehind(const SessionFusion& fusion, const Scatters& scatters) {
  FusionDof dof{{}, scatters.walk_dof};
  for (std::size_t s = 0; s < fusion.sensors.size(); ++s) dof.scatter.push_back(DofOfTaken(fusion, scatters, s));
  return dof;
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

void TakePoses(const SessionFusion& fusion, const NextVisit& told, const Scatters& scatters, GraphSolution& solution) {
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
                           IsToldInAnIsland(fusion, static_cast<int>(s)) ? VisitScatter{} : scatters.about_place[s],
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
                  const VisitDates& dates) {
  SessionFusion fusion = FusionOf({edges, within, reference, solution}, estimates, true);
  if (fusion.factors.empty() || fusion.sensors.size() > kFusedSensorsMax) return;
  TakeAges(dates, fusion);
  if (!SettleWithScatter(fusion)) return;
  Scatters scatters{ScattersAboutPlace(fusion), {}, {}, {}, TakeWalks(fusion)};
  if (!SettleWithScatter(fusion)) return;
  TakeScatter(pooled, fusion, scatters);
  const auto inverse = Settle(fusion);
  if (!inverse) return;
  MovesBetween moves = FindMovesBetween({edges, within, reference, solution}, estimates);
  solution.fused.moved = std::move(moves.moved);
  solution.fused.apart = std::move(moves.apart);
  const NextVisit told = NextVisitOf(fusion, *inverse, DofBehind(fusion, scatters));
  TakePoses(fusion, told, scatters, solution);
  solution.fused.held_back = HeldBackIn(estimates, fusion.sessions);
  solution.fused.clocks = ClocksIn(estimates, fusion.sessions);
  solution.fused.influential = InfluentialIn(estimates, fusion);
  solution.fused.lenses = LensesIn(estimates, fusion.sessions);
  solution.fused.sessions = fusion.sessions;
  solution.fused.made_by = MadeBy(estimates, fusion.sessions);
  solution.fused.sensors = fusion.sensors;
  solution.fused.covariance = told.covariance;
  solution.fused.next_visit_days = DaysUntilNext(fusion);
}

}  // namespace rigcal::graph
