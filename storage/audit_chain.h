// The hashes that hold the audit together. For storage/*.cc only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/model/approval/audit.h"

namespace rigcal::storage {

// The schema that has hashes: rows of before have none until ChainOldAudit.
inline constexpr int kAuditChainVersion = 22;

// Gives every row of before its hash, in the order of their numbers; the robot is what the row names. The same rows get
// the same hashes, whenever and wherever it is done. Call it once, in the transaction that makes the table. Throws
// SQLite::Exception.
void ChainOldAudit(SQLite::Database& database);

}  // namespace rigcal::storage
