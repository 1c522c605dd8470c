// What summaries of robots and lists of sessions show beyond their own rows.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/model/robots/robot_summary.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {

// Call inside the Write that appends the revision.
[[nodiscard]] Status AppendWorstEdge(Store& store, const RevisionKey& key, const WorstEdge& worst);

// Nothing checks an edge of the revision, or it was not kept: none.
[[nodiscard]] Result<std::optional<WorstEdge>> LoadWorstEdge(Store& store, const RevisionKey& key);

// Keys of a revision's causes (server/model/cause.h), each once. Call inside the Write that appends it.
[[nodiscard]] Status AppendCauseKeys(Store& store, const RevisionKey& key, const std::vector<std::string>& causes);
// Sorted; none of a revision from before they were kept.
[[nodiscard]] Result<std::vector<std::string>> LoadCauseKeys(Store& store, const RevisionKey& key);

// What the pairs of a session gave.
struct SessionFacts {
  std::int64_t good = 0, failed = 0;
};
// Of edges that count. Sessions without one are not in the map.
[[nodiscard]] Result<std::map<SessionId, SessionFacts>> LoadSessionFacts(Store& store,
                                                                         const std::vector<SessionId>& sessions);

}  // namespace rigcal::storage
