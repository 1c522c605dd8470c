// Trackers whose positions look like millimetres: no pair of theirs can be solved.
#include <algorithm>
#include <cmath>
#include <map>

#include "server/fleet/causes/root_causes.h"

namespace rigcal::fleet {
namespace {

struct Strides {
  double longest_m = 0.0;
  std::vector<const Edge*> edges;
};

RootCause InMillimetres(const SensorId& tracker, const Strides& strides) {
  RootCause cause{CauseKind::kPositionsUnit, {tracker}, {}, {}, IdsOf(strides.edges), {}, kPushAgain};
  const std::string metres = std::to_string(std::lround(strides.longest_m));
  cause.said.why = "the positions of " + tracker.str() + " look like millimetres: up to " + metres +
                   " m from one capture to the next";
  cause.said.what_to_do = "Give the positions in " + tracker.str() + "/poses.csv in metres";
  return cause;
}

}  // namespace

void FindPositionsUnits(CauseSearch& search) {
  std::map<SensorId, Strides> by_tracker;
  for (const Edge* edge : search.Take([](const Edge& one) { return FailedFor(one, {"positions_in_millimetres"}); }))
    for (const EdgeEnd& end : EndsOf(*edge))
      if (const auto step_m = end.Figure("positions_step", "_m")) {
        Strides& strides = by_tracker[end.sensor];
        strides.longest_m = std::max(strides.longest_m, *step_m);
        strides.edges.push_back(edge);
      }
  for (const auto& [tracker, strides] : by_tracker) search.causes.push_back(InMillimetres(tracker, strides));
}

}  // namespace rigcal::fleet
