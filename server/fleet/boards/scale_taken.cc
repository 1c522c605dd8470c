#include "server/fleet/boards/scale_taken.h"

#include <algorithm>
#include <array>
#include <set>

#include "server/fleet/findings/failures.h"
#include "server/fleet/wording.h"
#include "server/model/boards/measure.h"
#include "server/model/edges/past.h"
#include "server/model/sensors/unfound_boards.h"

namespace rigcal::fleet {
namespace {

bool IsByCameras(const Edge& edge, const SessionHeaders& headers) {
  const std::array<EdgeEnd, 2> ends = EndsOf(edge);
  return std::all_of(ends.begin(), ends.end(),
                     [&](const EdgeEnd& end) { return KindOf(headers, edge, end.sensor) == SensorKind::kCamera; });
}

bool IsTakenAsExact(const Target& board) { return board.serial.empty() && !(board.square_sigma_m > 0); }

}  // namespace

std::string ScaleTakenAsExact(const std::vector<Edge>& edges, const SessionHeaders& headers) {
  std::set<std::string> boards;
  for (const Edge& edge : edges) {
    if (IsPast(edge) || edge.state != EdgeState::kGood) continue;
    if (!IsByCameras(edge, headers)) return "";
    for (const Target* board : BoardsOf(headers, EndsOf(edge).front()))
      if (IsTakenAsExact(*board)) boards.insert(BoardName(*board) + " (" + BoardMm(board->square_m) + ")");
  }
  if (boards.empty()) return "";
  return "distances are as right as the stated size of " +
         List(std::vector<std::string>(boards.begin(), boards.end())) + ", which nothing else measures";
}

}  // namespace rigcal::fleet
