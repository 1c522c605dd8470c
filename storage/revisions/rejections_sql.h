// What was rejected and approved, as SQL: whoever rejects a revision rejects every one of its robot that has its
// document, which is the same calibration, and whoever approves a later copy of one approves that. For storage/*.cc
// only.
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

// Decisions `t` to use the revision of a decision or candidate by this name (robot_id, revision_number), or a later one
// with its document. An earlier one with it was approved as what was known then: it says nothing of this one.
[[nodiscard]] std::string ApprovalsOf(const std::string& columns, const std::string& candidate);

}  // namespace rigcal::storage
