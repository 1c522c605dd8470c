// Boards that were held too much alike to tell a lens or a pose.
#include <algorithm>
#include <set>

#include "server/fleet/causes/root_causes.h"
#include "server/fleet/wording.h"
#include "server/model/edges/method.h"

namespace rigcal::fleet {
namespace {

// Which ends of a failure the boards were too much alike for.
std::vector<SensorId> FlatEndsOf(const CauseSearch& search, const Edge& edge) {
  std::vector<SensorId> told, cameras, both = {edge.frame_a, edge.frame_b};
  for (const EdgeEnd& end : EndsOf(edge)) {
    if (end.Figure("board_tilt", "_rad")) told.push_back(end.sensor);
    if (KindOf(search.headers, edge, end.sensor) == SensorKind::kCamera) cameras.push_back(end.sensor);
  }
  if (!told.empty()) return told;
  return FailedFor(edge, {"no_normal_spread"}) || cameras.empty() ? both : cameras;
}

std::optional<double> LargestTilt_rad(const std::vector<const Edge*>& edges) {
  std::optional<double> largest;
  for (const Edge* edge : edges)
    for (const EdgeEnd& end : EndsOf(*edge))
      if (const auto tilt = end.Figure("board_tilt", "_rad")) largest = std::max(largest.value_or(0.0), *tilt);
  return largest;
}

RootCause AlikeBoards(const CauseSearch& search, CauseKind kind, const std::vector<const Edge*>& edges) {
  std::set<SensorId> sensors;
  for (const Edge* edge : edges)
    for (const SensorId& sensor : FlatEndsOf(search, *edge)) sensors.insert(sensor);
  RootCause cause{kind, {sensors.begin(), sensors.end()}, {}, {}, IdsOf(edges), {}, kCheckFirst};
  const std::string more = ": " + std::to_string(kCapturesMore) + " more captures";
  if (kind == CauseKind::kBoardPlaces) {
    cause.said = {"the board was seen in too few places by " + List(cause.sensors),
                  "Hold the board in all corners of the picture, near and far" + more};
    return cause;
  }
  const auto tilt_rad = LargestTilt_rad(edges);
  cause.said = {"the board was not tilted enough for " + List(cause.sensors) +
                    (tilt_rad ? ": by " + TwoDigits(kDegreesPerRadian * *tilt_rad, "deg") + " at most" : ""),
                "Tilt the board 30 degrees left, right, up and down" + more};
  return cause;
}

}  // namespace

void FindAlikeBoards(CauseSearch& search) {
  const auto tilt = search.Take([](const Edge& edge) { return FailedFor(edge, {"no_tilt", "no_normal_spread"}); });
  if (!tilt.empty()) search.causes.push_back(AlikeBoards(search, CauseKind::kBoardTilt, tilt));
  const auto places = search.Take([](const Edge& edge) {
    const bool stereo = edge.method == NameOf(Method::kStereo);
    return FailedFor(edge, {"distortion_not_observable"}) || (stereo && FailedFor(edge, {"ill_conditioned"}));
  });
  if (!places.empty()) search.causes.push_back(AlikeBoards(search, CauseKind::kBoardPlaces, places));
}

}  // namespace rigcal::fleet
