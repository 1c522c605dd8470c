// Sensors that were moved while a session was captured, as a pair of them by itself tells.
#include <map>
#include <set>
#include <tuple>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"

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

RootCause MovedWithin(const CauseSearch& search, const std::vector<const Edge*>& edges) {
  RootCause cause{CauseKind::kMovedWithin, EndsOfAll(edges), {}, {}, IdsOf(edges), {}, {}};
  const Edge& edge = *edges.front();
  const auto before = CaptureAt(edge, "moved_after_idx"), after = CaptureAt(edge, "moved_from_idx");
  if (before && after) cause.captures = {*before, *after};
  cause.said.why = OneOf(cause.sensors) + " was moved during the session of " +
                   NameOfSession(edge.session, search.captured_at) +
                   (before && after ? ", between captures " + before->str() + " and " + after->str() : "") + ", by " +
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
  std::map<std::pair<SessionId, std::optional<CaptureId>>, std::vector<const Edge*>> moves;
  for (const Edge* edge : search.Take([](const Edge& one) { return FailedFor(one, {"moved_within"}); }))
    moves[{edge->session, CaptureAt(*edge, "moved_from_idx")}].push_back(edge);
  for (const auto& [when, edges] : moves) search.causes.push_back(MovedWithin(search, edges));
}

}  // namespace rigcal::fleet
