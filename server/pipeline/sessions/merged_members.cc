#include "server/pipeline/sessions/merged_members.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "server/base/text.h"
#include "server/graph/fusion/merged_edge.h"
#include "server/model/approval/standing.h"
#include "server/model/edges/within_merged.h"
#include "server/pipeline/sessions/current_edges.h"
#include "storage/edges/edges.h"
#include "storage/revisions/merged_edges.h"
#include "storage/sessions/standing.h"

namespace rigcal::pipeline {
namespace {

// As a person names it: an edge that was pushed by its own id, one of a session by the session's.
std::string RetireCommandOf(const Edge& edge) {
  return edge.session.empty() ? RetireCommand(edge.id) : RetireCommand(edge.session);
}

std::string DayOf(const Edge& edge, const std::map<EdgeId, Stamp>& measured_at) {
  constexpr std::size_t kDateDigits = 10;
  const auto at = measured_at.find(edge.id);
  return at == measured_at.end() ? "" : " (" + ToIso(at->second).substr(0, kDateDigits) + ")";
}

// Of few all are named, of many the oldest and the newest.
std::string CureOf(const std::string& list, const std::vector<Edge>& within,
                   const std::map<EdgeId, Stamp>& measured_at) {
  constexpr std::size_t kNamedMax = 3;
  const auto named = [&](const Edge& edge) { return "`" + RetireCommandOf(edge) + "`" + DayOf(edge, measured_at); };
  const std::string all = "`" + list + "` lists them";
  if (within.empty()) return "Retire what is wrong of these: " + all + ".";
  if (within.size() > kNamedMax)
    return "Retire what is wrong of these: " + all + ", from the oldest, " + named(within.front()) +
           ", to the newest, " + named(within.back()) + ".";
  std::string text;
  for (const Edge& edge : within) text += (text.empty() ? "" : ", ") + named(edge);
  return "Retire what is wrong of these: " + text + ".";
}

Error ToldOf(const EdgeId& id, const FoundMerged& found, const std::vector<Edge>& within,
             const std::map<EdgeId, Stamp>& measured_at) {
  const MergedEdge& merged = found.merged;
  const std::string pair = merged.frame_a.str() + " - " + merged.frame_b.str();
  const std::string many = std::to_string(merged.count) + (merged.of_sessions ? " earlier session" : " earlier edge") +
                           (merged.count == 1 ? "" : "s");
  return {ErrorCode::kConflict,
          "edge " + id.str().substr(0, 16) + " was measured by nobody: it stands for what " + many + " of robot " +
              found.robot.str() + " said of " + pair,
          CureOf(WithinCommand(found.robot, id), within, measured_at)};
}

}  // namespace

Result<std::optional<FoundMerged>> FindMerged(storage::Store& store, const EdgeId& id, const RobotId& robot) {
  using Found = std::optional<FoundMerged>;
  RIGCAL_ASSIGN(const auto known, storage::FindRobotOfMerged(store, id));
  const RobotId whose = known.value_or(robot);
  if (whose.empty()) return Found();
  RIGCAL_ASSIGN(const auto all, storage::LoadMergedEdges(store, whose));
  for (const MergedEdge& merged : all)
    if (graph::EdgeOf(merged, whose, false).id == id) return Found({whose, merged});
  return Found();
}

Result<std::vector<Edge>> LoadWithin(storage::Store& store, const FoundMerged& found) {
  RIGCAL_ASSIGN(const auto ids, storage::LoadIdsWithin(store, found.robot, found.merged));
  RIGCAL_ASSIGN(auto edges, storage::LoadEdges(store, ids, false));
  RIGCAL_ASSIGN(const auto counts, storage::LoadWhatCounts(store, found.robot));
  RIGCAL_TRY(MarkPast(store, counts, edges));
  std::erase_if(edges, [](const Edge& edge) { return edge.state != EdgeState::kGood; });
  RIGCAL_ASSIGN(const auto measured_at, storage::LoadMeasuredAt(store, edges));
  std::sort(edges.begin(), edges.end(), [&](const Edge& x, const Edge& y) {
    return std::tie(measured_at.at(x.id), x.id) < std::tie(measured_at.at(y.id), y.id);
  });
  return edges;
}

Result<FoundMerged> OnlyMerged(storage::Store& store, const std::string& prefix, const RobotId& robot) {
  RIGCAL_TRY(storage::FindEdges(store, prefix, robot));  // says what is no beginning of an id
  RIGCAL_ASSIGN(const auto ids, storage::FindMergedEdges(store, prefix, robot));
  if (ids.size() > 1)
    return Fail(ErrorCode::kConflict, std::to_string(ids.size()) + " merged edges begin with " + Quoted(prefix),
                "Give more of its digits.");
  if (!ids.empty()) {
    RIGCAL_ASSIGN(auto found, FindMerged(store, ids.front(), robot));
    if (found) return std::move(*found);
  }
  return Fail(ErrorCode::kNotFound,
              "no edge of the newest revision of robot " + robot.str() + " that stands for others begins with " +
                  Quoted(prefix),
              "Each revision gives them ids of its own: see its report, or `rigcal show " + robot.str() + " --json`.");
}

Status CheckIsNotMerged(storage::Store& store, const std::string& prefix, const RobotId& robot) {
  RIGCAL_ASSIGN(const auto ids, storage::FindMergedEdges(store, prefix, robot));
  if (ids.size() != 1) return {};
  RIGCAL_ASSIGN(const auto found, FindMerged(store, ids.front(), robot));
  if (!found) return {};
  RIGCAL_ASSIGN(const auto within, LoadWithin(store, *found));
  RIGCAL_ASSIGN(const auto measured_at, storage::LoadMeasuredAt(store, within));
  return Fail(ToldOf(ids.front(), *found, within, measured_at));
}

}  // namespace rigcal::pipeline
