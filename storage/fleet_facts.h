// What summaries of robots and lists of sessions show beyond their own rows.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/model/robot_summary.h"
#include "storage/revisions.h"

namespace rigcal::storage {

// Call inside the Write that appends the revision.
[[nodiscard]] Status AppendWorstEdge(Store& store, const RevisionKey& key, const WorstEdge& worst);

// Nothing checks an edge of the revision, or it was not kept: none.
[[nodiscard]] Result<std::optional<WorstEdge>> LoadWorstEdge(Store& store, const RevisionKey& key);

// What the pairs of a session gave.
struct SessionFacts {
  std::int64_t good = 0, failed = 0;
};
[[nodiscard]] Result<std::map<SessionId, SessionFacts>> LoadSessionFacts(Store& store, const std::vector<SessionId>& sessions);

}  // namespace rigcal::storage
