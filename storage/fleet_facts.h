// What lists of robots and of sessions show beyond their own rows: one or two queries, however many.
#pragma once

#include <map>
#include <optional>
#include <vector>

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

// What the pairs of a session gave.
struct SessionFacts {
  std::int64_t good = 0, failed = 0;
};
[[nodiscard]] Result<std::map<SessionId, SessionFacts>> LoadSessionFacts(Store& store, const std::vector<SessionId>& sessions);

}  // namespace rigcal::storage
