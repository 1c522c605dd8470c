#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "server/fleet/findings/failures.h"
#include "server/fleet/findings/findings.h"
#include "server/fleet/retire_text.h"
#include "server/fleet/wording.h"
#include "server/model/edges/merged_edge.h"

namespace rigcal::fleet {
namespace {

std::map<EdgeId, const Edge*> ById(const std::vector<Edge>& edges) {
  std::map<EdgeId, const Edge*> by_id;
  for (const Edge& edge : edges) by_id.emplace(edge.id, &edge);
  return by_id;
}

std::vector<std::string> NamesOf(const std::vector<EdgeId>& ids, const std::map<EdgeId, const Edge*>& by_id) {
  std::vector<std::string> names;
  for (const EdgeId& id : ids) {
    const auto edge = by_id.find(id);
    names.push_back(edge == by_id.end() ? id.str().substr(0, 12) : NameOfEdge(*edge->second));
  }
  return names;
}

const SuspectEdge& WorstOf(const std::vector<SuspectEdge>& suspects) {
  const SuspectEdge* worst = &suspects.front();
  for (const SuspectEdge& suspect : suspects)
    if (suspect.statistic * worst->limit > worst->statistic * suspect.limit) worst = &suspect;
  return *worst;
}

std::string NameOf(const SuspectEdge& suspect) { return suspect.frame_a.str() + " - " + suspect.frame_b.str(); }

Edge WholeEdgeOf(const SuspectEdge& suspect, const std::vector<Edge>& edges) {
  Edge edge;
  if (const auto by_id = ById(edges); by_id.contains(suspect.edge)) edge = *by_id.at(suspect.edge);
  edge.id = suspect.edge, edge.frame_a = suspect.frame_a, edge.frame_b = suspect.frame_b;
  return edge;
}

// A loop does not say which of its edges is wrong.
Finding OpenLoop(const SuspectEdge& suspect, const std::vector<Edge>& edges, const Policy& policy) {
  std::vector<std::string> names = NamesOf(suspect.alternatives, ById(edges));
  names.insert(names.begin(), NameOf(suspect));
  DecidingFigure figure =
      OffFigure("Loop open by", suspect.e, LimitsOf(policy, suspect.frame_a, suspect.frame_b).moved_min);
  figure.limit += ": " + List(names);
  return {
      "the loop of edges " + List(names) + " does not close: " + OffList(suspect.e) + " off, and one of them is wrong",
      "Capture these pairs again, or one more pair of their sensors to see which",
      {},
      std::move(figure)};
}

std::vector<std::pair<SensorId, SensorId>> PairsOf(const std::vector<SuspectEdge>& suspects) {
  std::vector<std::pair<SensorId, SensorId>> pairs;
  for (const SuspectEdge& suspect : suspects) pairs.emplace_back(suspect.frame_a, suspect.frame_b);
  return pairs;
}

DecidingFigure FigureOf(std::string name, const SuspectEdge& worst, const Policy& policy) {
  return OffFigure(std::move(name), worst.e, LimitsOf(policy, worst.frame_a, worst.frame_b).moved_min);
}

Finding SensorDoesNotFit(const SensorId& sensor, const std::vector<SuspectEdge>& suspects, const SuspectEdge& worst,
                         const std::vector<Edge>& edges, const Policy& policy) {
  std::vector<SensorId> others;
  for (const SuspectEdge& suspect : suspects)
    others.push_back(suspect.frame_a == sensor ? suspect.frame_b : suspect.frame_a);
  const std::string name = sensor.str();
  const std::string why =
      name + " does not fit the other measurements: " + OffList(worst.e) + " off at worst, against " + List(others);
  DecidingFigure figure = FigureOf(name + " off by", worst, policy);
  if (!MeetSessionsAt({sensor}, edges))
    return {why,
            "Measure " + name + " against " + List(others) +
                " again, or take these pairs out, the worst first: " + RetireText(WholeEdgeOf(worst, edges)),
            {sensor},
            std::move(figure)};
  return {why + "; it may have been moved",
          "Was " + name + " moved? Yes: `rigcal push FOLDER --remounted " + name +
              "`. No: check its name and its mount, capture again",
          {sensor},
          std::move(figure)};
}

// Without a sensor that all of them have.
Finding EdgesDoNotFit(const std::vector<SuspectEdge>& suspects, const SuspectEdge& worst,
                      const std::vector<Edge>& edges, const Policy& policy) {
  std::vector<std::string> names = {NameOf(worst)};
  std::set<SensorId> sensors;
  for (const SuspectEdge& suspect : suspects) {
    if (&suspect != &worst) names.push_back(NameOf(suspect));
    sensors.insert({suspect.frame_a, suspect.frame_b});
  }
  const std::string why = List(names) + " do not fit the other measurements: " + OffList(worst.e) + " off at worst";
  DecidingFigure figure = FigureOf(NameOf(worst) + " off by", worst, policy);
  const std::vector<SensorId> accused(sensors.begin(), sensors.end());
  if (!MeetSessionsAt(sensors, edges))
    return {why, "Measure them again, or take them out, the worst first: " + RetireText(WholeEdgeOf(worst, edges)),
            accused, std::move(figure)};
  const std::string a = worst.frame_a.str(), b = worst.frame_b.str();
  return {why + "; sensors may have been moved",
          "Was " + a + " or " + b + " moved? Yes: `rigcal push FOLDER --remounted " + a + "`, or " + b +
              ". No: check the names of all, capture them again",
          accused, std::move(figure)};
}

std::set<SessionId> SessionsOf(const std::vector<EdgeId>& ids, const std::map<EdgeId, const Edge*>& by_id) {
  std::set<SessionId> sessions;
  for (const EdgeId& id : ids)
    if (const auto edge = by_id.find(id); edge != by_id.end())
      sessions.insert(IsMergedOfSessions(*edge->second) ? kMergedHistory : edge->second->session);
  return sessions;
}

// The newest of a group; nothing where one of its sessions has no date.
std::optional<SessionId> NewestIn(const std::set<SessionId>& sessions, const SessionTimes& captured_at) {
  std::optional<SessionId> newest;
  for (const SessionId& session : sessions) {
    if (!captured_at.contains(session)) return std::nullopt;
    if (!newest || captured_at.at(*newest) < captured_at.at(session)) newest = session;
  }
  return newest;
}

// "after 2026-01-31": from the newest session of the older group on.
std::string WhenMoved(const std::set<SessionId>& a, const std::set<SessionId>& b, const SessionTimes& captured_at) {
  const auto of_a = NewestIn(a, captured_at), of_b = NewestIn(b, captured_at);
  if (!of_a || !of_b || *of_a == *of_b) return "between these sessions";
  return "after " + NameOfSession(captured_at.at(*of_a) < captured_at.at(*of_b) ? *of_a : *of_b, captured_at);
}

// Of a group of this session alone, where two or more in the other group are newer: these agree, and nothing is loose.
std::optional<SessionId> OddSession(const std::set<SessionId>& group, const std::set<SessionId>& others,
                                    const SessionTimes& captured_at) {
  if (group.size() != 1 || !captured_at.contains(*group.begin())) return std::nullopt;
  const Stamp odd_at = captured_at.at(*group.begin());
  const auto newer = std::count_if(others.begin(), others.end(), [&](const SessionId& other) {
    return captured_at.contains(other) && odd_at < captured_at.at(other);
  });
  return newer > 1 ? std::optional(*group.begin()) : std::nullopt;
}

// What sessions say is told apart by when they were captured, edges without one by an epoch. Edges too weak to tell go
// with the larger group, so one session may be in both. `either`: of these one was moved.
std::string CureOf(const TwoPoses& two, const std::vector<SensorId>& either, const std::map<EdgeId, const Edge*>& by_id,
                   const SessionTimes& captured_at) {
  const std::string name = either.front().str();
  const std::string was = "Was " + name + (either.size() > 1 ? " or " + either.back().str() : "") + " moved ";
  const std::set<SessionId> a = SessionsOf(two.group_a, by_id), b = SessionsOf(two.group_b, by_id);
  if (a.contains(SessionId()) || b.contains(SessionId())) {
    const auto first = by_id.find(two.group_a.empty() ? EdgeId() : two.group_a.front());
    const std::string robot = first == by_id.end() ? "" : first->second->robot.str();
    return was + "between these measurements? Yes: `rigcal epoch " + (robot.empty() ? "ROBOT" : robot) + " --sensor " +
           name +
           " --reason \"WHY\"`, then push what was measured since. No: take the wrong edges out with `rigcal "
           "retire EDGE --reason \"WHY\"`";
  }
  if (a == b)
    return was + "during the session? Tighten its mount, capture again, then `rigcal push FOLDER --remounted " + name +
           "`";
  const std::string yes =
      was + WhenMoved(a, b, captured_at) + "? Yes: `rigcal push FOLDER --remounted " + name + "` of the later session";
  auto odd = OddSession(a, b, captured_at);
  if (!odd) odd = OddSession(b, a, captured_at);
  if (odd) return yes + CureOfOddSession(*odd, captured_at);
  return yes + ". No: tighten its mount, capture again, then `rigcal push FOLDER --remounted " + name + "`";
}

std::string EdgesText(std::size_t edges) { return std::to_string(edges) + (edges == 1 ? " edge" : " edges"); }

// Pairs of sensors once each.
std::string PairsText(const std::vector<EdgeId>& ids, const std::map<EdgeId, const Edge*>& by_id) {
  std::vector<std::string> pairs;
  for (const std::string& name : NamesOf(ids, by_id))
    if (std::find(pairs.begin(), pairs.end(), name) == pairs.end()) pairs.push_back(name);
  return pairs.size() == ids.size() ? (ids.size() == 1 ? "edge " : "edges ") + List(pairs)
                                    : EdgesText(ids.size()) + " of " + List(pairs);
}

// Of a group whose edges all come from sessions these are named, as what can be looked at and repeated; the oldest
// first.
std::string GroupText(const std::vector<EdgeId>& ids, const std::map<EdgeId, const Edge*>& by_id,
                      const SessionTimes& captured_at) {
  const std::set<SessionId> sessions = SessionsOf(ids, by_id);
  if (sessions.empty() || sessions.contains(SessionId())) return PairsText(ids, by_id);
  std::vector<std::string> names;
  for (const SessionId& session : sessions)
    if (session != kMergedHistory) names.push_back(NameOfSession(session, captured_at));
  std::sort(names.begin(), names.end());
  const std::string edges = EdgesText(ids.size()) + " of ";
  const std::string earlier = sessions.contains(kMergedHistory) ? "the sessions before the newest ones" : "";
  if (names.empty()) return edges + earlier;
  return edges + (earlier.empty() ? "" : earlier + " and of ") + (names.size() == 1 ? "session " : "sessions ") +
         List(names);
}

// Where its edges all join it to the same sensor, nobody can tell which of both was moved. What is not the reference
// comes first.
std::vector<SensorId> EitherOf(const TwoPoses& two, const std::map<EdgeId, const Edge*>& by_id,
                               const GraphSolution& solution) {
  std::set<SensorId> ends;
  for (const auto* group : {&two.group_a, &two.group_b})
    for (const EdgeId& id : *group)
      if (const auto edge = by_id.find(id); edge != by_id.end())
        ends.insert({edge->second->frame_a, edge->second->frame_b});
  if (ends.size() != 2 || !ends.contains(two.sensor)) return {two.sensor};
  std::vector<SensorId> either(ends.begin(), ends.end());
  const SensorPose* reference = ReferenceOf(solution);
  if (reference != nullptr && either.front() == reference->sensor) std::swap(either.front(), either.back());
  return either;
}

}  // namespace

std::optional<Finding> FindTwoPoses(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                                    const SessionTimes& captured_at) {
  if (solution.suspects.two_poses.empty()) return std::nullopt;
  const TwoPoses& two = solution.suspects.two_poses.front();
  const auto by_id = ById(edges);
  const std::vector<SensorId> either = EitherOf(two, by_id, solution);
  const auto says = [](const std::vector<EdgeId>& group) { return group.size() == 1 ? " agrees on " : " agree on "; };
  std::string why = (either.size() == 1 ? two.sensor.str() + " has two poses, "
                                        : List(either) + " have two poses against each other, ") +
                    OffText(two.difference) + " apart: " + GroupText(two.group_a, by_id, captured_at) +
                    says(two.group_a) + "one, " + GroupText(two.group_b, by_id, captured_at) + " on the other";
  const std::size_t more = solution.suspects.two_poses.size() - 1;
  if (more > 0) why += " (and " + std::to_string(more) + (more == 1 ? " more sensor" : " more sensors") + " likewise)";
  return Finding{
      why, CureOf(two, either, by_id, captured_at), either,
      OffFigure("Two poses of " + List(either) + " apart by", two.difference, LimitsOf(policy, two.sensor).moved_min)};
}

std::optional<Finding> FindSuspectEdges(const std::vector<Edge>& edges, const GraphSolution& solution,
                                        const Policy& policy) {
  const std::vector<SuspectEdge>& suspects = solution.suspects.edges;
  if (suspects.empty()) return std::nullopt;
  const SuspectEdge& worst = WorstOf(suspects);
  if (suspects.size() == 1 && !worst.alternatives.empty()) return OpenLoop(worst, edges, policy);
  const std::vector<SensorId> shared = SharedBy(PairsOf(suspects));
  if (shared.size() == 1) return SensorDoesNotFit(shared.front(), suspects, worst, edges, policy);
  if (shared.empty()) return EdgesDoNotFit(suspects, worst, edges, policy);
  return DoNotFit(WholeEdgeOf(worst, edges), worst.e, edges, policy);
}

}  // namespace rigcal::fleet
