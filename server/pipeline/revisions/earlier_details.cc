#include "server/pipeline/revisions/earlier_details.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "server/report/edges/edge_order.h"
#include "storage/revisions/revisions.h"

namespace rigcal::pipeline {
namespace {

// Captured last; of several the one with the larger id.
SessionId NewestOf(const std::vector<report::SessionFacts>& sessions) {
  const auto newest = std::max_element(sessions.begin(), sessions.end(), [](const auto& x, const auto& y) {
    return std::tie(x.captured_at.ns, x.id) < std::tie(y.captured_at.ns, y.id);
  });
  return newest == sessions.end() ? SessionId() : newest->id;
}

// The first revision that had all of each session.
Result<std::map<SessionId, int>> LoadRevisionsOf(storage::Store& store, const report::ReportInput& input,
                                                 std::int64_t watermark) {
  std::vector<SessionId> sessions;
  for (const report::SessionFacts& facts : input.sessions) sessions.push_back(facts.id);
  return storage::LoadFirstRevisions(store, input.revision.robot, watermark, sessions);
}

}  // namespace

Result<std::map<EdgeId, int>> LoadDetailedEarlier(storage::Store& store, const report::ReportInput& input,
                                                  std::int64_t watermark) {
  RIGCAL_ASSIGN(const auto first, LoadRevisionsOf(store, input, watermark));
  const SessionId newest = NewestOf(input.sessions);
  std::set<EdgeId> here = report::WorthDetails(input);
  for (const report::CameraReport& camera : input.cameras) here.insert(camera.edge);
  std::map<EdgeId, int> earlier;
  for (const Edge& edge : input.revision.edges) {
    const auto number = first.find(edge.session);
    if (number == first.end() || number->second >= input.number || edge.session == newest) continue;
    if (!here.contains(edge.id)) earlier.emplace(edge.id, number->second);
  }
  return earlier;
}

}  // namespace rigcal::pipeline
