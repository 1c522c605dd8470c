// READ: the lenses of two revisions side by side, for the page that compares them.
#pragma once

#include <map>

#include "server/report/robot_pages.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// Of each camera the fits that the two reports show; both revisions whole, `captured_at` of the sessions of their
// edges. Only fits that differ are read. More cameras than a page shows are named, not compared.
[[nodiscard]] report::ComparedLenses CompareLenses(storage::Store& store, const report::SolvedRevision& before,
                                                   const report::SolvedRevision& now,
                                                   const std::map<SessionId, Stamp>& captured_at);

}  // namespace rigcal::pipeline
