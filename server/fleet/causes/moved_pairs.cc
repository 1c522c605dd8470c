// Sensors that were moved while a session was captured, as a pair of them by itself tells.
#include <algorithm>
#include <cstring>
#include <map>
#include <set>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"
#include "server/model/edges/past.h"

namespace rigcal::fleet {
namespace {

std::optional<CaptureId> CaptureAt(const Edge& edge, const char* figure) {
  const auto idx = edge.figures.find(figure);
  if (idx == edge.figures.end() || !(idx->second >= 0 && idx->second < static_cast<double>(edge.captures.size())))
    return std::nullopt;
  return edge.captures[static_cast<std::size_t>(idx->second)].capture;
}

double FigureOr0(const Edge& edge, const char* name) {
  const auto figure = edge.figures.find(name);
  return figure == edge.figures.end() ? 0.0 : figure->second;
}

// Who was moved is an end of each of the pairs; where that leaves none, several were.
std::vector<SensorId> EndsOfAll(const std::vector<const Edge*>& edges) {
  std::set<SensorId> of_all, of_any;
  for (const Edge* edge : edges)
    for (const SensorId& sensor : {edge->frame_a, edge->frame_b}) {
      of_any.insert(sensor);
      if (std::all_of(edges.begin(), edges.end(), [&](const Edge* other) { return IsEndOf(*other, sensor); }))
        of_all.insert(sensor);
    }
  const std::set<SensorId>& ends = of_all.empty() ? of_any : of_all;
  return {ends.begin(), ends.end()};
}

std::string OneOf(const std::vector<SensorId>& sensors) {
  if (sensors.size() != 2) return List(sensors);
  return sensors[0].str() + " or " + sensors[1].str();
}

// By the numbers within their names, as they were taken.
bool IsBefore(const CaptureId& x, const CaptureId& y) { return strverscmp(x.str().c_str(), y.str().c_str()) < 0; }

// One move, as some pairs of a session tell it: each saw other captures, and it was between those that all tell.
struct Move {
  CaptureId after, from;
  std::vector<const Edge*> edges;

  [[nodiscard]] bool MayBe(const Move& other) const {
    return !IsBefore(from, other.after) && from != other.after && !IsBefore(other.from, after) && other.from != after;
  }
  void Add(const Move& other) {
    if (IsBefore(after, other.after)) after = other.after;
    if (IsBefore(other.from, from)) from = other.from;
    edges.insert(edges.end(), other.edges.begin(), other.edges.end());
  }
};

RootCause MovedWithin(const CauseSearch& search, const Move& move) {
  RootCause cause{CauseKind::kMovedWithin, EndsOfAll(move.edges), {}, {}, IdsOf(move.edges), {}, {}};
  const Edge& edge = *move.edges.front();
  const bool told = !move.after.empty() && !move.from.empty();  // an edge that somebody else made may lack them
  if (told) cause.captures = {move.after, move.from};
  cause.said.why = OneOf(cause.sensors) + " was moved during the session of " +
                   NameOfSession(edge.session, search.captured_at) +
                   (told ? ", between captures " + move.after.str() + " and " + move.from.str() : "") + ", by " +
                   Number(1e3 * FigureOr0(edge, "moved_m"), "mm") + " and " +
                   Number(kDegreesPerRadian * FigureOr0(edge, "moved_rad"), "deg") + ", or a lens changed";
  cause.said.what_to_do = "Tighten the mount of " + List(cause.sensors) + ", lock focus and zoom, capture again";
  cause.command = std::string(kPushAgain) + " --remounted ";
  for (const SensorId& sensor : cause.sensors)
    cause.command += (sensor == cause.sensors.front() ? "" : ",") + sensor.str();
  return cause;
}

}  // namespace

void FindMovedPairs(CauseSearch& search) {
  std::map<SessionId, std::vector<Move>> sessions;
  for (const Edge* edge : search.Take(TellsMove)) {
    const auto after = CaptureAt(*edge, "moved_after_idx"), from = CaptureAt(*edge, "moved_from_idx");
    const Move move{after.value_or(CaptureId()), from.value_or(CaptureId()), {edge}};
    std::vector<Move>& moves = sessions[edge->session];
    const auto same = std::find_if(moves.begin(), moves.end(), [&](const Move& one) { return one.MayBe(move); });
    if (same == moves.end())
      moves.push_back(move);
    else
      same->Add(move);
  }
  for (const auto& [session, moves] : sessions)
    for (const Move& move : moves) search.causes.push_back(MovedWithin(search, move));
}

bool IsOfNewestVisit(const RootCause& cause, const std::vector<Edge>& edges, const SessionTimes& captured_at) {
  std::optional<Stamp> own, newest;
  for (const Edge& edge : edges)
    if (const auto time = captured_at.find(edge.session); time != captured_at.end() && !IsPast(edge)) {
      newest = std::max(newest, std::optional(time->second));
      if (std::find(cause.edges.begin(), cause.edges.end(), edge.id) != cause.edges.end())
        own = std::max(own, std::optional(time->second));
    }
  return own == newest;
}

}  // namespace rigcal::fleet
