// Of each revision, what held when it was made: the software that solved it, and what its robot was to use then.
#pragma once

#include <optional>
#include <string>

#include "storage/revisions/revisions.h"

namespace rigcal::storage {

struct RevisionMade {
  std::string software;       // version of rigcald
  std::optional<int> in_use;  // the revision that the robot was to use once this one was stored; nothing: none
};
// Call inside Write, after AppendRevision and what was decided about it at once.
[[nodiscard]] Status AppendRevisionMade(Store& store, const RevisionKey& key, const RevisionMade& made);
// Nothing of a revision from before revisions kept it (0056_placed_poses.sql).
[[nodiscard]] Result<std::optional<RevisionMade>> LoadRevisionMade(Store& store, const RevisionKey& key);

}  // namespace rigcal::storage
