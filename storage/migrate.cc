#include "storage/migrate.h"

#include "newest_schema.h"
#include "schema.h"
#include "server/base/log.h"
#include "storage/audit_chain.h"
#include "storage/audited_rows.h"

namespace rigcal::storage {
namespace {

constexpr int kVersionsTold = 8;

// In the log, as a store of years takes a while. None is told of a new one.
std::string SchemaText(int version) {
  return "schema " + std::to_string(version) + " of " + std::to_string(NewestSchemaVersion());
}

void TellStep(int from, int version) {
  if (from > 0) LogInfo("the store is being brought forward: at " + SchemaText(version));
}

}  // namespace

void RunMissingSchema(Connection& connection) {
  // Another process may have migrated since the version was read.
  const int version = SchemaVersionOf(connection);
  if (version == 0 && connection.engine().TakesWholeSchema())
    return connection.engine().RunSchema(newest::kBuiltFiles.front().second);
  for (int next = version; next < NewestSchemaVersion(); ++next) {
    const auto& [name, sql] = schema::kEmbeddedFiles.at(static_cast<std::size_t>(next));
    connection.engine().RunSchema(sql);
    if (next + 1 == kAuditChainVersion) ChainOldAudit(connection);
    HoldRowsOfBefore(connection, name, SystemClock().Now());
    if ((next + 1) % kVersionsTold == 0) TellStep(version, next + 1);
  }
}

std::vector<std::string_view> SchemaTexts() {
  std::vector<std::string_view> files;
  for (const auto& [name, sql] : schema::kEmbeddedFiles) files.push_back(sql);
  return files;
}

int NewestSchemaVersion() { return static_cast<int>(schema::kEmbeddedFiles.size()); }

int SchemaVersionOf(Connection& connection) { return connection.engine().LoadSchemaState().version; }

Error UnfinishedError(const std::string& place) {
  return {ErrorCode::kConflict, "the store at " + place + " is a copy of another that is not finished",
          "Run the same `rigcal migrate-store` again: it goes on where it was broken off."};
}

Status CheckVersion(Connection& connection, const std::string& place) {
  const SchemaState state = connection.engine().LoadSchemaState();
  if (!state.is_ours && (state.version != 0 || !state.is_empty))
    return Fail(ErrorCode::kConflict, "what is at " + place + " is a database, but not a store of rigcal",
                "Name another one, or move what is there away.");
  if (state.version > kUnfinishedVersion) return Fail(UnfinishedError(place));
  if (state.version > NewestSchemaVersion())
    return Fail(ErrorCode::kUnsupported,
                "the store at " + place + " has schema version " + std::to_string(state.version) +
                    ", this rigcald understands up to " + std::to_string(NewestSchemaVersion()),
                "Install the rigcald that wrote it, or a newer one.");
  return {};
}

Status Migrate(Connection& connection) {
  const int from = SchemaVersionOf(connection);
  if (from == NewestSchemaVersion()) return {};
  if (from > 0)
    LogInfo("the store is brought forward from " + SchemaText(from) + ": nothing is asked of it until then");
  const Status done = connection.Write([&]() -> Status {
    RunMissingSchema(connection);
    connection.engine().NoteSchemaVersion(NewestSchemaVersion());
    return {};
  });
  if (done && from > 0) LogInfo("the store was brought forward to " + SchemaText(NewestSchemaVersion()));
  // A connection that knew the tables of before is told that they are others now: by another process that began at
  // once.
  const bool is_done =
      !done && done.error().code == ErrorCode::kUnsupported && SchemaVersionOf(connection) == NewestSchemaVersion();
  return is_done ? Status{} : done;
}

}  // namespace rigcal::storage
