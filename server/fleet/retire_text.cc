#include "server/fleet/retire_text.h"

#include "server/model/approval/standing.h"
#include "server/model/edges/merged_edge.h"
#include "server/model/edges/within_merged.h"

namespace rigcal::fleet {

std::string RetireText(const Edge& edge) {
  if (!IsMerged(edge)) return "`" + RetireCommand(edge.id) + "`";
  const bool of_sessions = IsMergedOfSessions(edge);
  const int count = static_cast<int>(edge.figures.at(of_sessions ? kMergedSessions : kMergedEdges));
  const std::string many = std::to_string(count) + (of_sessions ? " earlier session" : " earlier edge");
  return "it stands for " + many + (count == 1 ? "" : "s") + "; `" + WithinCommand(edge.robot, edge.id) +
         "` lists what to retire of these";
}

}  // namespace rigcal::fleet
