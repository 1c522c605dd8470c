// READ: a revision with every detail of its edges, which its document refers to by their ids.
#pragma once

#include "server/formats/documents.h"
#include "storage/store.h"

namespace rigcal::pipeline {

enum class Blocks { kLoaded, kLeftOut };

// State, diagnoses, residual and influence of an edge are what the document says: what the store has as good may be
// past in the revision. All else comes from the store, also of edges that a document of format 1 has whole, of which
// only block vectors do. Merged edges are those of that revision, without block vectors. kStorage names an edge that is
// missing.
[[nodiscard]] Result<formats::RevisionInput> LoadWholeRevision(storage::Store& store, const Revision& revision,
                                                               Blocks blocks);
// The same of its document as it was read.
[[nodiscard]] Result<formats::RevisionInput> WithWholeEdges(storage::Store& store, int number,
                                                            formats::RevisionInput document, Blocks blocks);

}  // namespace rigcal::pipeline
