// What a list of all robots shows beyond their newest revisions: two queries, however many robots.
#pragma once

#include <map>
#include <optional>

#include "server/base/stamp.h"
#include "storage/revisions.h"

namespace rigcal::storage {

// The edge of a revision that fits worst.
struct WorstEdge {
  SensorId frame_a, frame_b;
  double in_sigmas = 0.0;  // its residual over its own sigma
};
// Call inside the Write that appends the revision.
[[nodiscard]] Status AppendWorstEdge(Store& store, const RevisionKey& key, const WorstEdge& worst);

struct FleetFacts {
  std::optional<Stamp> last_session_at;  // captured_at of the newest closed session
  std::optional<WorstEdge> worst;        // of the newest revision; absent: nothing checks an edge, or it was not kept
};
[[nodiscard]] Result<std::map<RobotId, FleetFacts>> LoadFleetFacts(Store& store);

}  // namespace rigcal::storage
