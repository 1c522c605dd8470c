// The hashes that hold the audit together. For storage/*.cc only.
#pragma once

#include "server/model/approval/audit.h"
#include "storage/database/connection.h"

namespace rigcal::storage {

// The schema that has hashes: rows of before have none until ChainOldAudit.
inline constexpr int kAuditChainVersion = 22;

// Gives every row of before its hash, in the order of their numbers; the robot is what the row names. The same rows get
// the same hashes, whenever and wherever it is done. Call it once, in the transaction that makes the table. Throws
// what the engine throws.
void ChainOldAudit(Connection& connection);

}  // namespace rigcal::storage
