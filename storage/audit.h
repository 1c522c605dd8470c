// The audit: who decided what. Append-only, and chained: each row's hash covers the row and the hash before it.
#pragma once

#include <optional>
#include <vector>

#include "server/model/approval/audit.h"
#include "storage/store.h"

namespace rigcal::storage {

enum class AuditedKind { kDecision, kStanding, kPolicy, kRigModel, kBoardMeasure };
// A row of their tables, by its number.
struct AuditedRow {
  AuditedKind kind = AuditedKind::kDecision;
  std::int64_t number = 0;
};

// The only way into the audit. `robot`: that it is about, if it is about one. `about`: the row that was written for
// what was decided, in the same Write; the audit row's hash covers it. kStorage where the audit is damaged so that no
// row can follow: then nothing may be decided.
[[nodiscard]] Status AppendAudit(Store& store, Stamp now, const std::string& who, const std::string& what,
                                 const RobotId& robot = {}, const std::optional<AuditedRow>& about = {});
// Whether another row can follow: the same kStorage before anything is written.
[[nodiscard]] Status CheckAuditGoesOn(Store& store);

// The newest first, up to `limit` with numbers below `before` (0: from the newest on); only those about `robot` if it
// is not empty.
[[nodiscard]] Result<std::vector<AuditRow>> LoadAudit(Store& store, const RobotId& robot, std::int64_t before = 0,
                                                      std::int64_t limit = kAllRows);

// Walks through all of it, and through the rows that it holds: rows without an audit row, audit rows without their row,
// rows that were changed. Of each decision also through the document and the poses of its revision, whether they are
// those that it was about; this takes as long as reading all of them. That the newest rows are missing, all of them
// from some row on, no chain can tell: compare the head with one that was kept elsewhere.
[[nodiscard]] Result<AuditCheck> VerifyAudit(Store& store);

}  // namespace rigcal::storage
