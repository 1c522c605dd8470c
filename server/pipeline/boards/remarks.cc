#include "server/pipeline/boards/remarks.h"

#include <set>

#include "server/fleet/boards/remarks.h"
#include "server/model/edges/past.h"
#include "storage/boards/measures.h"
#include "storage/boards/uses.h"

namespace rigcal::pipeline {

Result<std::vector<BoardRemark>> LoadBoardRemarks(storage::Store& store, const std::vector<SessionId>& sessions) {
  RIGCAL_ASSIGN(const auto boards, storage::LoadSessionBoards(store, sessions));
  RIGCAL_ASSIGN(const BoardRegistry registry, storage::LoadRegistryOf(store, boards));
  return fleet::RemarksOn(boards, registry);
}

std::vector<SessionId> SessionsCountedIn(const std::vector<Edge>& edges) {
  std::set<SessionId> sessions;
  for (const Edge& edge : edges)
    if (!edge.session.empty() && !IsPast(edge)) sessions.insert(edge.session);
  return {sessions.begin(), sessions.end()};
}

}  // namespace rigcal::pipeline
