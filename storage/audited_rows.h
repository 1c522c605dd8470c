// The rows that decide, as the audit holds them: decisions, standings, policies. For storage/*.cc only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>

#include <optional>
#include <string>

#include "server/model/approval/audit.h"

namespace rigcal::storage {

// The file of storage/schema after which the rows of before are to be held.
inline constexpr const char* kAuditedRowsSchema = "0030_held_decisions.sql";

// Of the row of this kind and number as it is stored now: sha256 of its kind and its columns, in the order in which
// docs/approval.md lists them, a line feed between each two; nothing: there is no such row. All of these throw
// SQLite::Exception.
[[nodiscard]] std::optional<Digest> HashOfHeldRow(SQLite::Database& database, const std::string& kind,
                                                  std::int64_t number);
// Appends one audit row for each kind of which there are rows already, which holds all of these together. Call it
// once, in the transaction that makes the table; the audit is chained by then.
void HoldRowsOfBefore(SQLite::Database& database, Stamp now);
// What is not as the audit holds it, both ways, and how many rows are from before. Call it inside Read.
void CheckHeldRows(SQLite::Database& database, AuditCheck& check);

}  // namespace rigcal::storage
