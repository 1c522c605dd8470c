// What was rejected, as SQL: whoever rejects a revision rejects every one of its robot that has its document, which is
// the same calibration. For storage/*.cc only.
#pragma once

#include <string>

namespace rigcal::storage {

// Of a decision `other`, that it counts: until `until`, an expression; empty: all do. No WITH: that would be worked out
// whole for each question.
[[nodiscard]] std::string DecidedUntil(const std::string& until, const std::string& other);
// Decisions `r` that reject a revision `v` with this document, an expression, and after which nobody said another thing
// of that revision.
[[nodiscard]] std::string RejectionsOf(const std::string& columns, const std::string& robot, const std::string& digest,
                                       const std::string& until = "");
// Of a decision by this name to use a revision, that nobody rejected since what the revision is.
[[nodiscard]] std::string NotRejectedSince(const std::string& decision, const std::string& until = "");

}  // namespace rigcal::storage
