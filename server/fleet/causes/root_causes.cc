#include "server/fleet/causes/root_causes.h"

#include <algorithm>
#include <set>

#include "server/fleet/causes/rig_causes.h"

namespace rigcal::fleet {
namespace {

bool IsWorse(const RootCause& x, const RootCause& y) {
  const bool x_exchanged = x.kind == CauseKind::kExchanged, y_exchanged = y.kind == CauseKind::kExchanged;
  return x_exchanged != y_exchanged ? x_exchanged : x.edges.size() > y.edges.size();
}

}  // namespace

std::vector<RootCause> FindRootCauses(const std::vector<Edge>& edges, const GraphSolution& solution,
                                      const SessionHeaders& headers, const SessionTimes& captured_at,
                                      const ExpectedRig& expected, const std::set<SensorId>& retired) {
  const SessionHeaders current = WithoutPast(headers, edges);
  CauseSearch search{edges, solution, current, captured_at, expected, retired};
  search.open = FindOpenFailures(edges, captured_at);
  for (const auto find :
       {FindFileCauses, FindPositionsUnits, FindNominalUnits, FindBoardCounts, FindExchanged, FindBoardSizes,
        FindLensModels, FindMovedPairs, FindAlikeBoards, FindUnseenBoards, FindShortSessions, FindFarFromNominal,
        FindNotMeasured, FindSensorsMissing, FindPairsMissing, FindOffRigModel})
    find(search);
  std::stable_sort(search.causes.begin(), search.causes.end(), IsWorse);
  return std::move(search.causes);
}

bool IsOfTheSession(CauseKind kind) {
  return kind == CauseKind::kBoardTilt || kind == CauseKind::kBoardPlaces || kind == CauseKind::kShortSession;
}

Finding FindingOf(const RootCause& cause) {
  Finding finding = cause.said;
  if (!cause.command.empty()) finding.what_to_do += ", then `" + cause.command + "`";
  if (finding.accused.empty() && !IsOfTheSession(cause.kind)) finding.accused = cause.sensors;
  return finding;
}

std::set<EdgeId> ExplainedBy(const std::vector<RootCause>& causes) {
  std::set<EdgeId> explained;
  for (const RootCause& cause : causes) explained.insert(cause.edges.begin(), cause.edges.end());
  return explained;
}

std::vector<EdgeId> IdsOf(const std::vector<const Edge*>& edges) {
  std::vector<EdgeId> ids;
  for (const Edge* edge : edges) ids.push_back(edge->id);
  return ids;
}

}  // namespace rigcal::fleet
