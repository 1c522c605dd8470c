// The schema's version and the way forward to it. For storage/*.cc only.
#pragma once

#include <string>

#include "storage/database/connection.h"

namespace rigcal::storage {

// Number of files in storage/schema: the version that this program understands.
[[nodiscard]] int NewestSchemaVersion();
// Throws SQLite::Exception.
[[nodiscard]] int SchemaVersionOf(Connection& connection);
// Refuses a newer version (kUnsupported) and a database that is not ours (kConflict); writes nothing. `folder` is the
// store's name in errors. Throws SQLite::Exception.
[[nodiscard]] Status CheckVersion(Connection& connection, const std::string& folder);
// Runs what is missing of storage/schema in one transaction.
[[nodiscard]] Status Migrate(Connection& connection);

}  // namespace rigcal::storage
