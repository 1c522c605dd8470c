#include "server/fleet/findings/findings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/fleet/findings/bridges.h"
#include "server/fleet/findings/effect.h"
#include "server/fleet/retire_text.h"
#include "server/fleet/wording.h"
#include "server/math/statistics.h"
#include "server/math/tangent.h"
#include "server/model/edges/captures_wanted.h"
#include "server/model/edges/merged_edge.h"
#include "server/model/edges/past.h"
#include "server/model/graph/unchecked.h"

namespace rigcal::fleet {
namespace {

std::pair<SensorId, SensorId> PairOf(const Edge& edge) { return std::minmax(edge.frame_a, edge.frame_b); }

// How far beyond its limit an edge is. One that cannot be tested is held against the policy's plain limit.
double RatioOf(const EdgeResidual& residual, const EdgeTest& test, const Policy& policy) {
  if (!residual.in_solution) return 0.0;
  if (test.limit > 0.0) return test.statistic / test.limit;
  return TimesLimit(residual.e, ResidualMaxOf(policy));
}

// Independent edges of known information.
bool CostIsChiSquare(const std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  return std::all_of(edges.begin(), edges.end(), [&](const Edge& edge) {
    if (edge.state != EdgeState::kGood) return true;
    return edge.uncertainty.dof == 0 && (edge.session.empty() || sessions.insert(edge.session).second);
  });
}

// Moved between two visits, a sensor is contradicted by its own past, which no repetition takes away.
std::string CureOfLoop(const CycleResidual& loop, const std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (std::find(loop.edges.begin(), loop.edges.end(), edge.id) != loop.edges.end()) {
      sessions.insert(edge.session);
      if (IsMergedOfSessions(edge)) sessions.insert(kMergedHistory);  // many
    }
  const std::string sensors = List(loop.sensors);
  if (sessions.size() < 2 || loop.sensors.empty()) return "Capture " + sensors + " again";
  const std::vector<SensorId> others(loop.sensors.begin() + 1, loop.sensors.end());
  return "Was one of them moved between the sessions? Yes: `rigcal push FOLDER --remounted " +
         loop.sensors.front().str() + "` of the later one, or " + List(others) + " in its place. No: capture " +
         sensors + " again";
}

// That an edge was measured from. One that was pushed tells by what its covariance was estimated from. Nothing: it does
// not tell, as its covariance is known exactly, its poses make no captures, or it stands for many edges.
std::optional<std::int64_t> CapturesOf(const Edge& edge) {
  if (!edge.captures.empty())
    return std::count_if(edge.captures.begin(), edge.captures.end(), [](const auto& one) { return one.used; });
  const Uncertainty& known = edge.uncertainty;
  if (!edge.session.empty() || IsMerged(edge) || (known.dof == 0 && known.blocks.empty())) return std::nullopt;
  return std::max<std::int64_t>(known.dof > 0 ? known.dof + 1 : 0, static_cast<std::int64_t>(known.blocks.size()));
}

std::optional<Finding> FindWorstLoop(const Cycles& cycles, const std::vector<Edge>& edges, const Policy& policy) {
  const std::vector<const CycleResidual*> loops = cycles.Loops();
  const auto found = std::find_if(loops.begin(), loops.end(), [](const CycleResidual* loop) { return loop->fails(); });
  if (found == loops.end()) return std::nullopt;
  const CycleResidual& worst = **found;
  std::string why = "the loop of " + List(worst.sensors) + " does not close: " + OffList(worst.e) + " off, " +
                    Number(worst.t_squared / worst.limit, "times") + " what chance allows";
  if (cycles.failing > 1) why += " (" + std::to_string(cycles.failing) + " loops do not)";
  DecidingFigure figure = OffFigure("Loop open by", worst.e, LimitsOfLoop(policy, worst.sensors).moved_min);
  figure.limit += ": " + List(worst.sensors);
  return Finding{why, CureOfLoop(worst, edges), {}, std::move(figure)};
}

std::pair<SensorId, SensorId> EndsOfPair(const Edge& edge) { return {edge.frame_a, edge.frame_b}; }

}  // namespace

std::vector<SensorId> SharedBy(const std::vector<std::pair<SensorId, SensorId>>& pairs) {
  if (pairs.empty()) return {};
  std::vector<SensorId> shared = {pairs.front().first, pairs.front().second};
  for (const auto& [a, b] : pairs)
    std::erase_if(shared, [&a = a, &b = b](const SensorId& sensor) { return a != sensor && b != sensor; });
  return shared;
}

std::optional<Contradiction> MostContradicting(const std::vector<Edge>& edges, const GraphSolution& solution,
                                               const Policy& policy) {
  std::map<EdgeId, const Edge*> by_id;
  for (const Edge& edge : edges) by_id.emplace(edge.id, &edge);
  const auto edge_count = static_cast<std::size_t>(std::count_if(solution.residuals.begin(), solution.residuals.end(),
                                                                 [](const EdgeResidual& r) { return r.in_solution; }));
  std::optional<Contradiction> worst;
  double worst_ratio = 1.0;
  for (const EdgeResidual& residual : solution.residuals) {
    const auto found = by_id.find(residual.edge);
    if (found == by_id.end()) continue;
    const double ratio = RatioOf(residual, TestResidual(*found->second, residual, edge_count, policy), policy);
    if (ratio > worst_ratio && !IsSmall(*found->second, solution, policy))
      worst = Contradiction{found->second, residual.e}, worst_ratio = ratio;
  }
  return worst;
}

bool MeetSessionsAt(const std::set<SensorId>& sensors, const std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood || !(sensors.contains(edge.frame_a) || sensors.contains(edge.frame_b))) continue;
    if (IsMergedOfSessions(edge)) return true;  // of many
    if (!edge.session.empty()) sessions.insert(edge.session);
  }
  return sessions.size() > 1;
}

Finding DoNotFit(const Edge& edge, const Vector6d& e, const std::vector<Edge>& edges, const Policy& policy) {
  const std::string first = edge.frame_a.str(), second = edge.frame_b.str();
  const PoseLimit limit = LimitsOf(policy, edge.frame_a, edge.frame_b).moved_min;
  const std::vector<SensorId> both = {edge.frame_a, edge.frame_b};
  DecidingFigure figure = OffFigure(NameOfEdge(edge) + " off by", e, limit);
  if (MeetSessionsAt({edge.frame_a, edge.frame_b}, edges))
    return {first + " and " + second + " do not fit the other measurements: " + OffList(e) +
                " off; one may have been moved",
            "Was " + first + " or " + second + " moved? Yes: `rigcal push FOLDER --remounted " + first + "`, or " +
                second + ". No: check their names, capture them again",
            both, std::move(figure)};
  return {NameOfEdge(edge) + " does not fit the other pairs: " + OffList(e) + " off (limit " + LimitText(limit) + ")",
          "Measure " + NameOfEdge(edge) + " again, or take it out: " + RetireText(edge), both, std::move(figure)};
}

std::optional<Finding> FindNoEdges(const std::vector<Edge>& edges) {
  const bool any = std::any_of(edges.begin(), edges.end(), [](const Edge& e) { return e.state == EdgeState::kGood; });
  if (any) return std::nullopt;
  if (edges.empty()) return Finding{"nothing has been calibrated yet", "Push a capture session"};
  if (std::all_of(edges.begin(), edges.end(), IsPast))
    return Finding{
        "all that was calibrated is past: it was retired, sensors were remounted since, or sessions corrected",
        "Push a session that calibrates them anew"};
  return Finding{"every calibration failed", "Open the failed edges, do what each of them says, and push again"};
}

std::optional<Finding> FindUnsettled(const GraphSolution& solution) {
  if (solution.converged) return std::nullopt;
  return Finding{"the graph did not settle",
                 "Look for an edge with a large residual and push its session again, corrected"};
}

std::optional<Finding> FindPastPairs(const std::vector<Edge>& edges) {
  std::set<std::pair<SensorId, SensorId>> measured;
  for (const Edge& edge : edges)
    if (!IsPast(edge)) measured.insert(PairOf(edge));
  std::vector<std::string> past;
  std::vector<std::pair<SensorId, SensorId>> pairs;
  bool all_remounted = true;
  for (const Edge& edge : edges) {
    if (!IsOfEarlierEpoch(edge) || !measured.insert(PairOf(edge)).second) continue;
    past.push_back(NameOfEdge(edge));
    pairs.push_back(EndsOfPair(edge));
    all_remounted = all_remounted && edge.diagnoses.front().code == kRemountedCode;
  }
  if (past.empty()) return std::nullopt;
  return Finding{List(past) + (past.size() == 1 ? " was" : " were") + " not measured since " +
                     (all_remounted ? "a sensor was remounted" : "an epoch of a sensor began"),
                 "Push a session that calibrates " + List(past) + " anew", SharedBy(pairs)};
}

std::optional<Finding> FindFailedEdges(const std::vector<const Edge*>& failures) {
  if (failures.empty()) return std::nullopt;
  std::vector<std::string> names;
  std::vector<std::pair<SensorId, SensorId>> pairs;
  std::set<std::string> cures;
  for (const Edge* edge : failures) {
    names.push_back(NameOfEdge(*edge));
    pairs.push_back(EndsOfPair(*edge));
    cures.insert(edge->diagnoses.empty() ? "" : edge->diagnoses.front().cure);
  }
  std::string cure = cures.size() == 1 ? *cures.begin() : "";
  if (!cure.empty() && cure.back() == '.') cure.pop_back();
  if (cure.empty()) cure = "Open each failed edge and do what its page says";
  return Finding{"the calibration of " + List(names) + " failed", cure, SharedBy(pairs)};
}

std::optional<Finding> FindFewCaptures(const std::vector<Edge>& edges, const Policy& policy) {
  if (!policy.captures_min) return std::nullopt;
  std::map<std::pair<SensorId, SensorId>, std::int64_t> most;
  for (const Edge& edge : edges) {
    if (edge.state != EdgeState::kGood) continue;
    std::int64_t& known = most[PairOf(edge)];
    known = std::max(known, CapturesOf(edge).value_or(*policy.captures_min));
  }
  std::vector<std::string> names;
  std::vector<std::pair<SensorId, SensorId>> pairs;
  std::int64_t fewest = *policy.captures_min;
  for (const auto& [pair, used] : most) {
    if (used >= *policy.captures_min) continue;
    fewest = std::min(fewest, used);
    names.push_back(pair.first.str() + " - " + pair.second.str());
    pairs.push_back(pair);
  }
  if (names.empty()) return std::nullopt;
  const std::string wanted = std::to_string(*policy.captures_min);
  return Finding{List(names) + (names.size() == 1 ? " was" : " were") + " measured from too few captures (" +
                     (names.size() == 1 ? "" : "at worst ") + std::to_string(fewest) + ", limit " + wanted + ")",
                 "Take " + wanted + " captures or more of each pair",
                 SharedBy(pairs),
                 {},
                 *policy.captures_min,
                 true};
}

namespace {

// With how many times its tolerance each is known, the worst first.
std::vector<std::pair<double, const SensorPose*>> UncertainPoses(const GraphSolution& solution, const Policy& policy) {
  std::vector<std::pair<double, const SensorPose*>> uncertain;
  for (const SensorPose& pose : solution.poses) {
    if (!pose.known) continue;
    const Vector6d sigma = pose.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const PoseLimit wanted = LimitsOf(policy, pose.sensor).tolerance;
    const double ratio = std::max(sigma.head<3>().maxCoeff() / wanted.m, sigma.tail<3>().maxCoeff() / wanted.rad);
    if (ratio > 1.0) uncertain.emplace_back(ratio, &pose);
  }
  std::stable_sort(uncertain.begin(), uncertain.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  return uncertain;
}

}  // namespace

std::vector<SensorId> UncertainSensors(const GraphSolution& solution, const Policy& policy) {
  std::vector<SensorId> sensors;
  for (const auto& [ratio, pose] : UncertainPoses(solution, policy)) sensors.push_back(pose->sensor);
  return sensors;
}

std::string UncertainText(const GraphSolution& solution, const Policy& policy) {
  const auto uncertain = UncertainPoses(solution, policy);
  if (uncertain.empty()) return "";
  const SensorPose& worst = *uncertain.front().second;
  const Vector6d sigma = worst.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const PoseLimit wanted = LimitsOf(policy, worst.sensor).tolerance;
  const DecidingFigure figure = SigmaFigure("", sigma.head<3>().maxCoeff(), sigma.tail<3>().maxCoeff(), wanted);
  return ListAll(UncertainSensors(solution, policy)) + " (" + figure.value + ", " + figure.limit + ")";
}

std::optional<Finding> FindUncertainSensors(const GraphSolution& solution, const Policy& policy) {
  const auto uncertain = UncertainPoses(solution, policy);
  if (uncertain.empty()) return std::nullopt;
  const std::vector<SensorId> sensors = UncertainSensors(solution, policy);
  const Vector6d sigma = uncertain.front().second->covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const std::string names = List(sensors);
  const std::string known = sensors.size() == 1 ? "the pose of " + names + " is known to "
                                                : "the poses of " + names + " are known, at worst, to ";
  return Finding{known + SigmaText(sigma.head<3>().maxCoeff(), sigma.tail<3>().maxCoeff()) + " only (" +
                     LimitText(LimitsOf(policy, sensors.front()).tolerance) + " wanted)",
                 "Capture " + names + " at more distances and tilts", sensors,
                 SigmaFigure("Pose of " + sensors.front().str() + " known to", sigma.head<3>().maxCoeff(),
                             sigma.tail<3>().maxCoeff(), LimitsOf(policy, sensors.front()).tolerance)};
}

std::optional<Finding> FindUncheckedSensors(const std::vector<Edge>& edges, const GraphSolution& solution) {
  if (solution.dof <= 0)
    return Finding{"no loop of edges checks the result",
                   "Calibrate one more pair of sensors, or repeat a pair, so that the edges check each other"};
  const std::vector<SensorId> names = FindBridges(edges, solution).sensors;
  if (names.empty()) return std::nullopt;
  return Finding{"nothing checks the pose of " + List(names) + ": a single edge is the only tie to the reference",
                 "Calibrate " + List(names) + " against one more sensor, or repeat the pair", names};
}

std::optional<Finding> FindUntestable(const std::vector<Edge>& edges, const GraphSolution& solution,
                                      const Policy& policy) {
  if (solution.dof <= 0) return std::nullopt;
  const std::set<EdgeId> unchecked = UncheckedEdges(solution), bridges = FindBridges(edges, solution).edges;
  std::map<EdgeId, const Edge*> by_id;
  for (const Edge& edge : edges)
    if (edge.uncertainty.dof > 0 && !unchecked.contains(edge.id) && !bridges.contains(edge.id))
      by_id.emplace(edge.id, &edge);
  const int wanted = CapturesToAskFor(solution.residuals.size(), policy);
  std::vector<std::string> names;
  for (const EdgeResidual& residual : solution.residuals) {
    const auto edge = by_id.find(residual.edge);
    if (edge == by_id.end() || !residual.in_solution || CapturesOf(*edge->second).value_or(0) >= wanted) continue;
    const EdgeTest test = TestResidual(*edge->second, residual, solution.residuals.size(), policy);
    const std::string name = NameOfEdge(*edge->second);
    if (test.limit <= 0.0 && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  if (names.empty()) return std::nullopt;
  constexpr std::size_t kNamedMax = 3;  // of more a sentence tells how many: the same is done about each
  const std::string behind = names.size() > kNamedMax ? std::to_string(names.size()) + " pairs" : List(names);
  return Finding{"too few captures stand behind " + behind + " to test whether the edges agree",
                 "Take " + std::to_string(wanted) + " captures or more of each pair",
                 {},
                 {},
                 wanted};
}

bool IsCostBeyondChance(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy) {
  return solution.dof > 0 && CostIsChiSquare(edges) &&
         solution.cost > ChiSquareQuantile(policy.residual_probability, solution.dof);
}

std::optional<Finding> FindOpenLoops(const std::vector<Edge>& edges, const GraphSolution& solution,
                                     const Policy& policy) {
  if (solution.dof <= 0) return std::nullopt;
  // Many edges that agree outweigh one open loop in the cost.
  if (!IsCostBeyondChance(edges, solution, policy)) return FindWorstLoop(solution.cycles, edges, policy);
  if (AllIsSmall(edges, solution, policy)) return std::nullopt;
  const double limit = ChiSquareQuantile(policy.residual_probability, solution.dof);
  return Finding{"the loops of edges do not close within their sigmas (weighted cost " + PlainNumber(solution.cost) +
                     " for " + std::to_string(solution.dof) + " degrees of freedom, limit " + PlainNumber(limit) + ")",
                 "Capture the pair again that is off by most sigmas",
                 {},
                 {"Weighted cost of the loops", PlainNumber(solution.cost), "limit " + PlainNumber(limit)}};
}

std::string UntestedLoops(const std::vector<Edge>& edges, const GraphSolution& solution) {
  if (CostIsChiSquare(edges)) return "";
  const Cycles& cycles = solution.cycles;
  if (!cycles.judged) return cycles.why_not.empty() ? "" : "loops as a whole were not worked out";
  return cycles.tested == 0 ? "no loop could be tested as a whole" : "";
}

}  // namespace rigcal::fleet
