// A word about what counts, as a row of the table standing. For storage/*.cc only.
#pragma once

#include "server/model/approval/standing.h"
#include "storage/database/query.h"

namespace rigcal::storage {

// Columns number, how, at_ns, who, reason, from `column` on.
[[nodiscard]] inline Standing StandingAt(const Query& query, int column) {
  return {query.Int(column),
          query.Text(column + 1),
          {query.Time(column + 2), query.Text(column + 3), query.Text(column + 4)}};
}

// For the audit.
[[nodiscard]] inline std::string Because(const Word& word) { return word.reason.empty() ? "" : ": " + word.reason; }

}  // namespace rigcal::storage
