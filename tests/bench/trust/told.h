// What the service says of a session, from its raw observations to the verdict: the one place where a measure of trust
// asks it.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "server/model/graph/graph.h"
#include "server/model/sessions/session_estimate.h"
#include "tests/bench/rig/feature_session.h"

namespace rigcal {

// A sentence, and the sensors that it is about even where it does not name them: those of its edge.
struct Said {
  std::string code, text;  // the code of a diagnosis; empty: of the verdict
  std::set<SensorId> about;
};

struct Told {
  SensorId reference;
  std::vector<SensorPose> poses;  // with covariances and their degrees of freedom
  Verdict verdict;
  std::vector<Said> said;  // the verdict first, then every diagnosis of an edge
  int failed_edges = 0;
  std::string not_refined;           // why; empty: it was
  std::vector<TrackerClock> clocks;  // by the session that was captured last
};

// Visits of one robot, in their order, each as one session.
[[nodiscard]] Told Judge(const std::vector<FeatureSession>& visits);
[[nodiscard]] Told Judge(const FeatureSession& session);

}  // namespace rigcal
