// The audit: who decided what. Append-only, and chained: each row's hash covers the row and the hash before it.
#pragma once

#include <vector>

#include "server/model/audit.h"
#include "storage/store.h"

namespace rigcal::storage {

// The only way into the audit. `robot`: that it is about, if it is about one.
[[nodiscard]] Status AppendAudit(Store& store, Stamp now, const std::string& who, const std::string& what,
                                 const RobotId& robot = {});

// The newest first, up to `limit` with numbers below `before` (0: from the newest on); only those about `robot` if it
// is not empty.
[[nodiscard]] Result<std::vector<AuditRow>> LoadAudit(Store& store, const RobotId& robot, std::int64_t before = 0,
                                                      std::int64_t limit = kAllRows);

// Walks through all of it. That the newest rows are missing, all of them from some row on, no chain can tell: compare
// the head with one that was kept elsewhere.
[[nodiscard]] Result<AuditCheck> VerifyAudit(Store& store);

}  // namespace rigcal::storage
