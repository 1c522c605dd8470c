// Which disagreements of pairs count no more where their whole sessions were refined.
#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/findings/disagreements.h"
#include "server/fleet/findings/effect.h"
#include "server/fleet/wording.h"
#include "server/model/edges/merged_edge.h"
#include "server/model/edges/method.h"
#include "server/model/graph/connected.h"

namespace rigcal::fleet {
namespace {

std::set<EdgeId> EdgesOf(const std::vector<SessionId>& sessions, const std::vector<Edge>& edges) {
  const std::set<SessionId> refined(sessions.begin(), sessions.end());
  std::set<EdgeId> ids;
  for (const Edge& edge : edges)
    if (refined.contains(edge.session)) ids.insert(edge.id);
  return ids;
}

bool TellsOf(const SessionEstimate& estimate, const SensorId& sensor) {
  return sensor == estimate.reference || std::any_of(estimate.poses.begin(), estimate.poses.end(),
                                                     [&](const RefinedPose& pose) { return pose.sensor == sensor; });
}

// Nothing of a refinement stands for a sensor that is not in it: one that was left out, or is known in part; nor for a
// pair that ties two islands of a session.
void EraseUntold(const std::vector<SessionEstimate>& estimates, const std::vector<Edge>& edges,
                 std::set<EdgeId>& refined) {
  std::map<SessionId, std::vector<const SessionEstimate*>> of_session;  // the islands' too
  for (const SessionEstimate& estimate : estimates) of_session[estimate.session].push_back(&estimate);
  for (const Edge& edge : edges) {
    const auto found = of_session.find(edge.session);
    if (found == of_session.end()) continue;
    const bool is_told = std::any_of(found->second.begin(), found->second.end(), [&](const SessionEstimate* one) {
      return TellsOf(*one, edge.frame_a) && TellsOf(*one, edge.frame_b);
    });
    if (!is_told) refined.erase(edge.id);
  }
}

std::vector<std::set<SensorId>> TiedByEstimates(const std::vector<SessionEstimate>& estimates) {
  std::vector<std::set<SensorId>> told;
  for (const SessionEstimate& estimate : estimates) {
    if (!estimate.why_not.empty()) continue;
    std::set<SensorId>& sensors = told.emplace_back();
    for (const RefinedPose& pose : estimate.poses) sensors.insert(pose.sensor);
  }
  return Connected(told);
}

// One that ties two islands decides poses: what it says is its own.
bool AreTogether(const Edge& edge, const std::vector<std::set<SensorId>>& together) {
  return together.empty() || std::any_of(together.begin(), together.end(), [&](const std::set<SensorId>& sensors) {
           return sensors.contains(edge.frame_a) && sensors.contains(edge.frame_b);
         });
}

// Edges of sessions in which a board moved, or the world of a tracker of theirs, by methods that take boards to stand
// still.
std::set<EdgeId> BeforeMovedBoards(const std::vector<SessionEstimate>& estimates, const std::vector<Edge>& edges) {
  std::set<EdgeId> ids;
  for (const SessionEstimate& estimate : estimates)
    for (const BoardMovedWithin& moved : estimate.boards_moved)
      for (const Edge& edge : edges) {
        const std::optional<Method> method = MethodNamed(edge.method);
        const bool is_of = moved.world_of.empty() || edge.frame_a == moved.world_of || edge.frame_b == moved.world_of;
        if (edge.session == estimate.session && is_of && method && RowOf(*method).board_stands_still)
          ids.insert(edge.id);
      }
  return ids;
}

// Pairs of cameras whose given intrinsics their session's refinement found to be wrong: pairs take them as given.
std::set<EdgeId> ByWrongIntrinsics(const std::vector<SessionEstimate>& estimates, const std::vector<Edge>& edges) {
  std::set<EdgeId> ids;
  for (const SessionEstimate& estimate : estimates)
    for (const ContradictedLens& lens : estimate.contradicted_lenses)
      for (const Edge& edge : edges)
        if (edge.session == estimate.session && (edge.frame_a == lens.camera || edge.frame_b == lens.camera))
          ids.insert(edge.id);
  return ids;
}

// Pairs of two lidars that their session's refinement found to contradict all else: they entered no pose, but nothing
// stands for what they say either.
std::set<EdgeId> Contradicted(const std::vector<SessionEstimate>& estimates, const std::vector<Edge>& edges) {
  std::set<EdgeId> ids;
  for (const SessionEstimate& estimate : estimates)
    for (const ContradictedPair& pair : estimate.contradicted)
      for (const Edge& edge : edges)
        if (edge.session == estimate.session && std::minmax(edge.frame_a, edge.frame_b) == std::minmax(pair.a, pair.b))
          ids.insert(edge.id);
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
  const std::vector<std::set<SensorId>> together = TiedByEstimates(estimates);
  for (const Edge& edge : edges)
    if (IsMergedOfSessions(edge) && !solution.fused.sessions.empty() && is_fused(edge.frame_a) &&
        is_fused(edge.frame_b) && AreTogether(edge, together))
      refined.insert(edge.id);
  EraseUntold(estimates, edges, refined);
  for (const EdgeId& id : Contradicted(estimates, edges)) refined.erase(id);
  if (refined.empty()) return solution;
  std::set<EdgeId> known_wrong = BeforeMovedBoards(estimates, edges);
  known_wrong.merge(ByWrongIntrinsics(estimates, edges));
  const auto excused = [&](const Vector6d& e, std::initializer_list<std::vector<EdgeId>> groups) {
    bool small = !IsBeyond(e, ResidualMaxOf(policy));
    for (const std::vector<EdgeId>& ids : groups)
      for (const EdgeId& id : ids) {
        if (!refined.contains(id)) return false;
        small = small || known_wrong.contains(id);
      }
    return small;
  };
  GraphSolution judged = solution;
  std::erase_if(judged.suspects.two_poses, [&](const TwoPoses& two) {
    return excused(two.difference, {two.group_a, two.group_b});
  });
  std::erase_if(judged.suspects.edges, [&](const SuspectEdge& suspect) {
    return excused(suspect.e, {{suspect.edge}, suspect.alternatives});
  });
  std::erase_if(judged.residuals, [&](const EdgeResidual& residual) { return excused(residual.e, {{residual.edge}}); });
  for (auto* loops : {&judged.cycles.worst, &judged.cycles.others})
    std::erase_if(*loops, [&](const CycleResidual& cycle) {
      const bool gone = excused(cycle.e, {cycle.edges});
      judged.cycles.failing -= gone && cycle.fails() ? 1 : 0;
      return gone;
    });
  return judged;
}

std::string ExcusedDisagreement(const std::vector<Edge>& edges, const GraphSolution& solution, const Policy& policy,
                                bool pairs_disagree) {
  const std::string by_pairs = "taken pair by pair, ";
  const std::string no_pose = ", which enters no pose: each session was refined as a whole";
  const std::vector<Finding> large = FindLargeDisagreements(edges, solution, policy);
  if (!large.empty()) return by_pairs + large.front().why + no_pose;
  if (!pairs_disagree) return "";
  if (const auto worst = MostContradicting(edges, solution, policy)) {
    const Edge& edge = *worst->edge;
    return by_pairs + PairDiffers(edge.frame_a, edge.frame_b) +
           OffText(OffByOthers(solution, edge.id).value_or(worst->e)) + ", more than chance and " +
           LimitText(LimitsOfEdge(policy, edge).moved_min) + no_pose;
  }
  return by_pairs + "sensors do not agree" + no_pose;
}

}  // namespace rigcal::fleet
