// A board whose corners are counted wrong in session.yaml: nobody finds it.
#include <algorithm>
#include <map>
#include <set>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"
#include "server/model/edges/past.h"
#include "server/model/sensors/unfound_boards.h"

namespace rigcal::fleet {
namespace {

// What cameras saw of one board, in all pairs of a session.
struct Looks {
  const Target* board = nullptr;
  std::map<SensorId, double> pictures;  // that could be read, of cameras that found no board in any
  bool found = false;
};
using LooksByBoard = std::map<std::pair<SessionId, TargetId>, Looks>;

void TakeLook(const EdgeEnd& end, Looks& looks) {
  if (end.edge->state == EdgeState::kGood) looks.found = true;
  const auto sight = SightOf(end);
  if (!sight) return;
  looks.found |= sight->with_board > 0;
  double& pictures = looks.pictures[end.sensor];
  pictures = std::max(pictures, sight->readable());
}

LooksByBoard LooksOf(const CauseSearch& search) {
  LooksByBoard looks;
  for (const Edge& edge : search.edges) {
    if (IsPast(edge)) continue;
    for (const EdgeEnd& end : EndsOf(edge))
      if (KindOf(search.headers, edge, end.sensor) == SensorKind::kCamera)
        for (const Target* board : BoardsOf(search.headers, end)) {
          Looks& of_board = looks[{edge.session, board->id}];
          of_board.board = board;
          TakeLook(end, of_board);
        }
  }
  return looks;
}

// The boards that a camera of this failure looked for and that nobody found in the whole session.
std::vector<const Looks*> NeverFound(const CauseSearch& search, const Edge& edge, const LooksByBoard& looks) {
  std::vector<const Looks*> never;
  for (const EdgeEnd& end : EndsOf(edge)) {
    const auto sight = SightOf(end);
    if (!sight || sight->with_board > 0 || sight->LargestLoss() != Loss::kNoBoard) continue;
    if (KindOf(search.headers, edge, end.sensor) != SensorKind::kCamera) continue;
    for (const Target* board : BoardsOf(search.headers, end)) {
      const Looks& of_board = looks.at({edge.session, board->id});
      const bool looked = std::any_of(of_board.pictures.begin(), of_board.pictures.end(),
                                      [](const auto& camera) { return camera.second >= kPicturesToMissBoard; });
      if (of_board.found || !looked) return {};
      if (std::find(never.begin(), never.end(), &of_board) == never.end()) never.push_back(&of_board);
    }
  }
  return never;
}

RootCause WrongCounts(const std::vector<const Looks*>& boards, std::vector<EdgeId> edges) {
  RootCause cause{CauseKind::kBoardCounts, {}, {}, {}, std::move(edges), {}, kPushAgain};
  std::map<SensorId, double> cameras;
  std::vector<const Target*> targets;
  for (const Looks* looks : boards) {
    cause.boards.push_back(looks->board->id);
    targets.push_back(looks->board);
    cameras.insert(looks->pictures.begin(), looks->pictures.end());
  }
  double pictures = 0.0;
  for (const auto& [camera, count] : cameras) {
    cause.sensors.push_back(camera);
    pictures += count;
  }
  const std::string total = std::to_string(static_cast<long>(pictures)), described = DescribedBoards(targets);
  cause.said.why = cause.sensors.size() == 1
                       ? cause.sensors.front().str() + " found " + described + " in none of " + total + " pictures"
                       : described + " was not found in any of the " + total + " pictures of " + List(cause.sensors);
  cause.said.what_to_do = CureOfUnfoundBoards(targets);
  return cause;
}

}  // namespace

void FindBoardCounts(CauseSearch& search) {
  const LooksByBoard looks = LooksOf(search);
  const std::vector<const Edge*> taken =
      search.Take([&](const Edge& edge) { return SawTooLittle(edge) && !NeverFound(search, edge, looks).empty(); });
  std::map<SessionId, std::vector<const Edge*>> by_session;
  for (const Edge* edge : taken) by_session[edge->session].push_back(edge);
  for (const auto& [session, edges] : by_session) {
    std::vector<const Looks*> boards;
    for (const Edge* edge : edges)
      for (const Looks* looks_at : NeverFound(search, *edge, looks))
        if (std::find(boards.begin(), boards.end(), looks_at) == boards.end()) boards.push_back(looks_at);
    search.causes.push_back(WrongCounts(boards, IdsOf(edges)));
  }
}

}  // namespace rigcal::fleet
