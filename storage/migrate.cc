#include "storage/migrate.h"

#include <chrono>

#include "newest_schema.h"
#include "schema.h"
#include "server/base/log.h"
#include "storage/audit_chain.h"
#include "storage/audited_rows.h"

namespace rigcal::storage {
namespace {

// Of a store that is brought forward, in the log: its years may take minutes.
class MigrationProgress {
 public:
  explicit MigrationProgress(int from) : from_(from) {
    if (from_ > 0)
      LogInfo("the store is brought from schema " + std::to_string(from_) + " to " +
              std::to_string(NewestSchemaVersion()) + ": nothing is asked of it until that is done");
  }
  void Reached(int version) {
    const auto now = Clock::now();
    if (from_ == 0 || now - said_at_ < std::chrono::seconds(1)) return;
    said_at_ = now;
    LogInfo("the store is at schema " + std::to_string(version) + " of " + std::to_string(NewestSchemaVersion()) +
            " after " + SecondsText());
  }
  void Done() const {
    if (from_ > 0)
      LogInfo("the store was brought to schema " + std::to_string(NewestSchemaVersion()) + " in " + SecondsText());
  }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string SecondsText() const {
    return std::to_string(std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - began_).count()) + " s";
  }
  int from_;
  Clock::time_point began_ = Clock::now(), said_at_ = began_;
};

}  // namespace

void RunMissingSchema(Connection& connection) {
  // Another process may have migrated since the version was read.
  const int version = SchemaVersionOf(connection);
  if (version == 0 && connection.engine().TakesWholeSchema())
    return connection.engine().RunSchema(newest::kBuiltFiles.front().second);
  MigrationProgress progress(version);
  for (int next = version; next < NewestSchemaVersion(); ++next) {
    const auto& [name, sql] = schema::kEmbeddedFiles.at(static_cast<std::size_t>(next));
    connection.engine().RunSchema(sql);
    if (next + 1 == kAuditChainVersion) ChainOldAudit(connection);
    HoldRowsOfBefore(connection, name, SystemClock().Now());
    progress.Reached(next + 1);
  }
  progress.Done();
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
  if (SchemaVersionOf(connection) == NewestSchemaVersion()) return {};
  const Status done = connection.Write([&]() -> Status {
    RunMissingSchema(connection);
    connection.engine().NoteSchemaVersion(NewestSchemaVersion());
    return {};
  });
  // A connection that knew the tables of before is told that they are others now: by another process that began at
  // once.
  const bool is_done =
      !done && done.error().code == ErrorCode::kUnsupported && SchemaVersionOf(connection) == NewestSchemaVersion();
  return is_done ? Status{} : done;
}

}  // namespace rigcal::storage
