// What the newest session of each revision found of the calibration in use before it (sessions/as_found.h).
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/model/sessions/as_found.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {

// Call inside Write, after AppendRevision.
[[nodiscard]] Status AppendAsFound(Store& store, const RevisionKey& key, const AsFound& found);
// Nothing of a revision without sessions, of one that waited for pairs, or from before it was kept.
[[nodiscard]] Result<std::optional<AsFound>> LoadAsFound(Store& store, const RevisionKey& key);
// Of those of `numbers` that have it.
[[nodiscard]] Result<std::map<int, AsFoundSummary>> LoadAsFoundSummaries(Store& store, const RobotId& robot,
                                                                         const std::vector<int>& numbers);

}  // namespace rigcal::storage
