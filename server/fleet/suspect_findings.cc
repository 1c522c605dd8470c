#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/findings.h"
#include "server/fleet/wording.h"
#include "server/model/merged_edge.h"
#include "server/model/method.h"

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

// A loop does not say which of its edges is wrong.
Finding OpenLoop(const SuspectEdge& suspect, const std::vector<Edge>& edges) {
  std::vector<std::string> names = NamesOf(suspect.alternatives, ById(edges));
  names.insert(names.begin(), NameOf(suspect));
  return {"the loop of edges " + List(names) + " does not close: it is off by " + OffText(suspect.e) +
              ", and one of them is wrong",
          "Repeat the sessions of these edges, or calibrate one more pair of their sensors to see which"};
}

std::set<SessionId> SessionsOf(const std::vector<EdgeId>& ids, const std::map<EdgeId, const Edge*>& by_id) {
  std::set<SessionId> sessions;
  for (const EdgeId& id : ids)
    if (const auto edge = by_id.find(id); edge != by_id.end())
      sessions.insert(IsMergedOfSessions(*edge->second) ? kMergedHistory : edge->second->session);
  return sessions;
}

// Only sessions have a date, and only what two of them say can be told apart by it. Edges too weak to tell go with the
// larger group, so one session may be in both.
std::string CureOf(const TwoPoses& two, const std::map<EdgeId, const Edge*>& by_id) {
  const std::string name = two.sensor.str();
  const std::set<SessionId> a = SessionsOf(two.group_a, by_id), b = SessionsOf(two.group_b, by_id);
  if (a.contains(SessionId()) || b.contains(SessionId()))
    return "Find out whether " + name +
           " was moved between these measurements. If not, repeat the wrong one. If so, edges that were pushed without "
           "a session keep counting, as they have no date: push what was measured since under a new robot name";
  if (a == b)
    return "Find out whether " + name + " was moved during a session, and repeat that with " + name + " fixed";
  return "Find out whether " + name +
         " was moved between these sessions. If so, push the one with the later captured_at again with --remounted " +
         name + "; if not, repeat it";
}

// Of a group whose edges all come from sessions these are named, as what can be looked at and repeated; the oldest
// first.
std::string GroupText(const std::vector<EdgeId>& ids, const std::map<EdgeId, const Edge*>& by_id,
                      const SessionTimes& captured_at) {
  const std::set<SessionId> sessions = SessionsOf(ids, by_id);
  if (sessions.empty() || sessions.contains(SessionId())) return "edges " + List(NamesOf(ids, by_id));
  std::vector<std::string> names;
  for (const SessionId& session : sessions)
    if (session != kMergedHistory) names.push_back(NameOfSession(session, captured_at));
  std::sort(names.begin(), names.end());
  const std::string edges = std::to_string(ids.size()) + (ids.size() == 1 ? " edge of " : " edges of ");
  const std::string earlier = sessions.contains(kMergedHistory) ? "the sessions before the newest ones" : "";
  if (names.empty()) return edges + earlier;
  return edges + (earlier.empty() ? "" : earlier + " and of ") + (names.size() == 1 ? "session " : "sessions ") + List(names);
}

std::set<EdgeId> EdgesOf(const std::vector<SessionId>& sessions, const std::vector<Edge>& edges) {
  const std::set<SessionId> refined(sessions.begin(), sessions.end());
  std::set<EdgeId> ids;
  for (const Edge& edge : edges)
    if (refined.contains(edge.session)) ids.insert(edge.id);
  return ids;
}

// Edges of sessions in which a board moved, by methods that take boards to stand still.
std::set<EdgeId> BeforeMovedBoards(const std::vector<SessionEstimate>& estimates, const std::vector<Edge>& edges) {
  std::vector<SessionId> sessions;
  for (const SessionEstimate& estimate : estimates)
    if (!estimate.boards_moved.empty()) sessions.push_back(estimate.session);
  std::set<EdgeId> ids = EdgesOf(sessions, edges);
  for (const Edge& edge : edges)
    if (const auto method = MethodNamed(edge.method); !method || !RowOf(*method).board_stands_still) ids.erase(edge.id);
  return ids;
}

}  // namespace

GraphSolution WithoutRefinedPairs(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                                  const std::vector<SessionEstimate>& estimates) {
  std::set<EdgeId> refined = EdgesOf(solution.fused.sessions, edges);
  const auto is_fused = [&](const SensorId& sensor) {  // or the reference, which is known exactly
    return std::any_of(solution.poses.begin(), solution.poses.end(), [&](const SensorPose& pose) {
      return pose.sensor == sensor && pose.known && (pose.fused || pose.covariance.isZero(0.0));
    });
  };
  for (const Edge& edge : edges)
    if (IsMergedOfSessions(edge) && !solution.fused.sessions.empty() && is_fused(edge.frame_a) && is_fused(edge.frame_b))
      refined.insert(edge.id);
  if (refined.empty()) return solution;
  const std::set<EdgeId> before_moved_boards = BeforeMovedBoards(estimates, edges);
  const auto excused = [&](const Vector6d& e, std::initializer_list<std::vector<EdgeId>> groups) {
    bool small = e.head<3>().norm() <= policy.residual_max_m && e.tail<3>().norm() <= policy.residual_max_rad;
    for (const std::vector<EdgeId>& ids : groups)
      for (const EdgeId& id : ids) {
        if (!refined.contains(id)) return false;
        small = small || before_moved_boards.contains(id);
      }
    return small;
  };
  GraphSolution judged = solution;
  std::erase_if(judged.suspects.two_poses,
                [&](const TwoPoses& two) { return excused(two.difference, {two.group_a, two.group_b}); });
  std::erase_if(judged.suspects.edges, [&](const SuspectEdge& suspect) {
    return excused(suspect.e, {{suspect.edge}, suspect.alternatives});
  });
  std::erase_if(judged.residuals, [&](const EdgeResidual& residual) { return excused(residual.e, {{residual.edge}}); });
  std::erase_if(judged.cycles.worst, [&](const CycleResidual& cycle) {
    const bool gone = excused(cycle.e, {cycle.edges});
    judged.cycles.failing -= gone && cycle.fails() ? 1 : 0;
    return gone;
  });
  return judged;
}

std::optional<Finding> FindTwoPoses(const std::vector<Edge>& edges, const GraphSolution& solution,
                                    const SessionTimes& captured_at) {
  if (solution.suspects.two_poses.empty()) return std::nullopt;
  const TwoPoses& two = solution.suspects.two_poses.front();
  const auto by_id = ById(edges);
  std::string why = "sensor " + two.sensor.str() + " has two poses, " + OffText(two.difference) +
                    " apart: " + GroupText(two.group_a, by_id, captured_at) + " agree on one, " +
                    GroupText(two.group_b, by_id, captured_at) + " on the other";
  const std::size_t more = solution.suspects.two_poses.size() - 1;
  if (more > 0) why += " (and " + std::to_string(more) + (more == 1 ? " more sensor" : " more sensors") + " likewise)";
  return Finding{why, CureOf(two, by_id)};
}

std::optional<Finding> FindSuspectEdges(const std::vector<Edge>& edges, const GraphSolution& solution) {
  const std::vector<SuspectEdge>& suspects = solution.suspects.edges;
  if (suspects.empty()) return std::nullopt;
  const SuspectEdge& worst = WorstOf(suspects);
  if (suspects.size() == 1 && !worst.alternatives.empty()) return OpenLoop(worst, edges);
  std::vector<std::string> names = {NameOf(worst)};
  for (const SuspectEdge& suspect : suspects)
    if (&suspect != &worst) names.push_back(NameOf(suspect));
  const std::string them = names.size() == 1 ? "it is" : "worst is the first,";
  return Finding{(names.size() == 1 ? "edge " : "edges ") + List(names) +
                     (names.size() == 1 ? " contradicts" : " contradict") + " the other edges: " + them + " off by " +
                     OffText(worst.e) + ", " + Number(worst.statistic / worst.limit, "times") + " what chance allows",
                 "Check that " + worst.frame_a.str() + " and " + worst.frame_b.str() +
                     " have not moved and are named right, then repeat their session, with --remounted if one has"};
}

}  // namespace rigcal::fleet
