#include "storage/migrate.h"

#include "schema.h"
#include "storage/audit_chain.h"
#include "storage/audited_rows.h"

namespace rigcal::storage {
namespace {

Status RunMissing(Connection& connection) {
  // Another process may have migrated since the version was read.
  const int version = SchemaVersionOf(connection);
  for (int next = version; next < NewestSchemaVersion(); ++next) {
    const auto& [name, sql] = schema::kEmbeddedFiles.at(static_cast<std::size_t>(next));
    connection.engine().RunSchema(sql);
    if (next + 1 == kAuditChainVersion) ChainOldAudit(connection);
    if (name == kAuditedRowsSchema) HoldRowsOfBefore(connection, SystemClock().Now());
  }
  connection.engine().NoteSchemaVersion(NewestSchemaVersion());
  return {};
}

}  // namespace

int NewestSchemaVersion() { return static_cast<int>(schema::kEmbeddedFiles.size()); }

int SchemaVersionOf(Connection& connection) { return connection.engine().LoadSchemaState().version; }

Status CheckVersion(Connection& connection, const std::string& place) {
  const SchemaState state = connection.engine().LoadSchemaState();
  if (!state.is_ours && (state.version != 0 || !state.is_empty))
    return Fail(ErrorCode::kConflict, "what is at " + place + " is a database, but not a store of rigcal",
                "Name another one, or move what is there away.");
  if (state.version > NewestSchemaVersion())
    return Fail(ErrorCode::kUnsupported,
                "the store at " + place + " has schema version " + std::to_string(state.version) +
                    ", this rigcald understands up to " + std::to_string(NewestSchemaVersion()),
                "Install the rigcald that wrote it, or a newer one.");
  return {};
}

Status Migrate(Connection& connection) {
  if (SchemaVersionOf(connection) == NewestSchemaVersion()) return {};
  const Status done = connection.Write([&] { return RunMissing(connection); });
  // A connection that knew the tables of before is told that they are others now: by another process that began at
  // once.
  const bool is_done =
      !done && done.error().code == ErrorCode::kUnsupported && SchemaVersionOf(connection) == NewestSchemaVersion();
  return is_done ? Status{} : done;
}

}  // namespace rigcal::storage
