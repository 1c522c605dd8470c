// What was decided about: the documents and poses of revisions, as their decisions hold them. For storage/*.cc only.
#pragma once

#include "server/model/approval/audit.h"
#include "storage/revisions/revisions.h"

namespace rigcal::storage {

// Of the poses that there are of a revision and their joint covariances: sha256 of lines that docs/approval.md lists.
// Throws what the engine throws.
[[nodiscard]] Digest HashOfPoses(Store& store, const RevisionKey& key);

// Adds a fault of each decision whose revision is gone, or has another document, digest or poses than it was about, and
// counts the decisions that hold none of these: of their revisions the document is held against the digest beside it.
// Call it inside Read. Throws what the engine throws.
void CheckDecidedContent(Store& store, AuditCheck& check);

}  // namespace rigcal::storage
