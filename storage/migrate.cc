#include "storage/migrate.h"

#include "schema.h"
#include "storage/audit_chain.h"
#include "storage/audited_rows.h"

namespace rigcal::storage {
namespace {

constexpr int kApplicationId = 0x5267436c;  // "RgCl" in the file's header

int Pragma(Connection& connection, const char* name) {
  return connection.database().execAndGet(std::string("PRAGMA ") + name).getInt();
}

bool IsEmpty(Connection& connection) {
  return connection.database().execAndGet("SELECT count(*) FROM sqlite_schema").getInt() == 0;
}

Status RunMissing(Connection& connection) {
  // Another process may have migrated since the version was read.
  const int version = SchemaVersionOf(connection);
  for (int next = version; next < NewestSchemaVersion(); ++next) {
    const auto& [name, sql] = schema::kEmbeddedFiles.at(static_cast<std::size_t>(next));
    connection.database().exec(std::string(sql));
    if (next + 1 == kAuditChainVersion) ChainOldAudit(connection.database());
    if (name == kAuditedRowsSchema) HoldRowsOfBefore(connection.database(), SystemClock().Now());
  }
  connection.database().exec("PRAGMA application_id = " + std::to_string(kApplicationId) +
                             "; PRAGMA user_version = " + std::to_string(NewestSchemaVersion()));
  return {};
}

}  // namespace

int NewestSchemaVersion() { return static_cast<int>(schema::kEmbeddedFiles.size()); }

int SchemaVersionOf(Connection& connection) { return Pragma(connection, "user_version"); }

Status CheckVersion(Connection& connection, const std::string& folder) {
  const int version = SchemaVersionOf(connection);
  const bool ours = Pragma(connection, "application_id") == kApplicationId;
  if (!ours && (version != 0 || !IsEmpty(connection)))
    return Fail(ErrorCode::kConflict, "rigcal.db in " + folder + " is a database, but not a store of rigcal",
                "Name another folder, or move the file away.");
  if (version > NewestSchemaVersion())
    return Fail(ErrorCode::kUnsupported,
                "the store at " + folder + " has schema version " + std::to_string(version) +
                    ", this rigcald understands up to " + std::to_string(NewestSchemaVersion()),
                "Install the rigcald that wrote it, or a newer one.");
  return {};
}

Status Migrate(Connection& connection) {
  if (SchemaVersionOf(connection) == NewestSchemaVersion()) return {};
  return connection.Write([&] { return RunMissing(connection); });
}

}  // namespace rigcal::storage
