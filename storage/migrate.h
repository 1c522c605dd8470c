// The schema's version and the way forward to it. For storage/*.cc only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "storage/database/connection.h"

namespace rigcal::storage {

// Number of files in storage/schema: the version that this program understands.
[[nodiscard]] int NewestSchemaVersion();
// Their contents, the oldest first.
[[nodiscard]] std::vector<std::string_view> SchemaTexts();
// A store that another is being copied into has the version of its tables and this: nobody else opens it.
inline constexpr int kUnfinishedVersion = 1'000'000;
// Throws what the engine throws.
[[nodiscard]] int SchemaVersionOf(Connection& connection);
// Of a store at `place` with that version.
[[nodiscard]] Error UnfinishedError(const std::string& place);
// Refuses an unfinished copy (kConflict), a newer version (kUnsupported) and a database that is not ours (kConflict);
// writes nothing. `place` is where the store is, for errors. Throws what the engine throws.
[[nodiscard]] Status CheckVersion(Connection& connection, const std::string& place);
// Runs what is missing of storage/schema, within a Write, of a new store all of it as one script (newest_schema.py)
// where the engine takes that; the version is still to be noted. Throws what the engine throws.
void RunMissingSchema(Connection& connection);
// Runs what is missing of storage/schema in one transaction. Of several processes at once one does it; the others wait.
[[nodiscard]] Status Migrate(Connection& connection);

}  // namespace rigcal::storage
