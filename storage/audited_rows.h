// The rows that decide, as the audit holds them: decisions, standings, policies, rig models, measures of boards. For
// storage/*.cc only.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/model/approval/audit.h"
#include "storage/database/connection.h"

namespace rigcal::storage {

// Of the row of this kind and number as it is stored now: sha256 of its kind and its columns, in the order in which
// docs/approval.md lists them, a line feed between each two; nothing: there is no such row. All of these throw
// what the engine throws.
[[nodiscard]] std::optional<Digest> HashOfHeldRow(Connection& connection, const std::string& kind, std::int64_t number);
// Call it after each file of storage/schema, in its transaction: appends one audit row for each kind that the audit
// holds from that file on and of which there are rows already, which holds all of these together.
void HoldRowsOfBefore(Connection& connection, std::string_view schema_file, Stamp now);
// What is not as the audit holds it, both ways, and how many rows are from before. Call it inside Read.
void CheckHeldRows(Connection& connection, AuditCheck& check);
// Counts it, and names it where not too many are named.
void AddRowFault(AuditFault fault, AuditCheck& check);
// In the fewest digits that read back as the same number: "0.025", "1e-05"; of both zeros "0".
[[nodiscard]] std::string HeldNumber(double value);

}  // namespace rigcal::storage
