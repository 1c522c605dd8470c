// The rows that decide, as the audit holds them: decisions, standings, policies. For storage/*.cc only.
#pragma once

#include <optional>
#include <string>

#include "server/model/approval/audit.h"
#include "storage/database/connection.h"

namespace rigcal::storage {

// The file of storage/schema after which the rows of before are to be held.
inline constexpr const char* kAuditedRowsSchema = "0030_held_decisions.sql";

// Of the row of this kind and number as it is stored now: sha256 of its kind and its columns, in the order in which
// docs/approval.md lists them, a line feed between each two; nothing: there is no such row. All of these throw
// what the engine throws.
[[nodiscard]] std::optional<Digest> HashOfHeldRow(Connection& connection, const std::string& kind, std::int64_t number);
// Appends one audit row for each kind of which there are rows already, which holds all of these together. Call it
// once, in the transaction that makes the table; the audit is chained by then.
void HoldRowsOfBefore(Connection& connection, Stamp now);
// What is not as the audit holds it, both ways, and how many rows are from before. Call it inside Read.
void CheckHeldRows(Connection& connection, AuditCheck& check);

}  // namespace rigcal::storage
