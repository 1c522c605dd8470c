// The schema's version and the way forward to it. For storage/*.cc only.
#pragma once

#include <string>

#include "storage/database/connection.h"

namespace rigcal::storage {

// Number of files in storage/schema: the version that this program understands.
[[nodiscard]] int NewestSchemaVersion();
// Throws what the engine throws.
[[nodiscard]] int SchemaVersionOf(Connection& connection);
// Refuses a newer version (kUnsupported) and a database that is not ours (kConflict); writes nothing. `place` is
// where the store is, for errors. Throws what the engine throws.
[[nodiscard]] Status CheckVersion(Connection& connection, const std::string& place);
// Runs what is missing of storage/schema in one transaction. Of several processes at once one does it; the others wait.
[[nodiscard]] Status Migrate(Connection& connection);

}  // namespace rigcal::storage
