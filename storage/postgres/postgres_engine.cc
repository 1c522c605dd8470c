#include "storage/postgres/postgres_engine.h"

#include <libpq-fe.h>

#include <algorithm>
#include <cstdlib>

#include "postgres_functions.h"
#include "storage/postgres/postgres_copy.h"
#include "storage/postgres/postgres_schema.h"
#include "storage/postgres/postgres_statement.h"
#include "storage/postgres/sql_tokens.h"

namespace rigcal::storage {
namespace {

// "rigcal" in ASCII: of all who write to a store.
constexpr const char* kWritersTurn = "; SELECT pg_advisory_xact_lock(125797031698796)";

// Several writers wait for their turns, first come, first served: each comes to its own as long as others write.
constexpr int kTurnPatience_ms = 2 * kPatience_ms;

// In the class of states that PostgreSQL leaves to others.
constexpr const char* kMigratedState = "RC001";

std::string FileOf(std::string_view name) {
  const auto file = std::find_if(postgres::kEmbeddedFiles.begin(), postgres::kEmbeddedFiles.end(),
                                 [&](const auto& one) { return one.first == name; });
  return std::string(file->second);
}

std::string Listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

// Those of the schema; what holds references to is not among them. The owner of a table may do that.
std::string TriggersOf(const std::vector<std::string>& tables, const std::string& act) {
  std::string sql;
  for (const std::string& table : tables) sql += "ALTER TABLE " + table + " " + act + " TRIGGER USER; ";
  return sql;
}

bool IsAmongStates(const std::string& state, std::initializer_list<std::string_view> states) {
  for (const std::string_view one : states)
    if (state.rfind(one, 0) == 0) return true;
  return false;
}

}  // namespace

Error ErrorOf(const PostgresFailure& failure, const std::string& subject) {
  const std::string what = subject + ": " + failure.what();
  const std::string& state = failure.state();
  if (state == kMigratedState)
    return {ErrorCode::kUnsupported, what, "Start it again, as the same version as the others."};
  if (state.empty() || IsAmongStates(state, {"08", "57P"}))
    return {ErrorCode::kStorage, what, "Check that PostgreSQL runs and can be reached from here."};
  if (IsAmongStates(state, {"23"}))
    return {ErrorCode::kConflict, what, "It contradicts what is stored: check the ids that it refers to."};
  if (IsAmongStates(state, {"55P03", "40"}))
    return {ErrorCode::kBusy, what, "Another process holds the database: wait, or stop it."};
  if (IsAmongStates(state, {"53100"})) return {ErrorCode::kStorage, what, "Free some space on the disk of PostgreSQL."};
  if (IsAmongStates(state, {"53300"}))
    return {ErrorCode::kBusy, what, "Raise max_connections of PostgreSQL, or stop what else uses it."};
  if (IsAmongStates(state, {"54", "22021", "22P05"}))
    return {ErrorCode::kInvalidInput, what, "Send less at once, and texts of UTF-8 without zero bytes."};
  if (IsAmongStates(state, {"28", "3D", "42501"}))
    return {ErrorCode::kStorage, what,
            "Check the database, the user and its rights, and the password that --store gives."};
  return {ErrorCode::kStorage, what, "Check the log of PostgreSQL, and that of rigcald."};
}

std::unique_ptr<EngineStatement> PostgresEngine::Prepare(const std::string& sql) {
  return std::make_unique<PostgresStatement>(link_, PostgresQueryOf(sql));
}

// A writer that stands still amid its write gives the lock back before the leases of others are over. What is read
// after the lock is what the writer before has committed: not so in a snapshot of the transaction's begin.
void PostgresEngine::BeginWrite() { BeginWith(kWritersTurn); }

void PostgresEngine::BeginWriteBeside() { BeginWith(""); }

void PostgresEngine::BeginWith(const std::string& turn) {
  const int patience_ms = patience_ms_ < kPatience_ms ? patience_ms_ : kTurnPatience_ms;
  std::string begin = "BEGIN ISOLATION LEVEL READ COMMITTED; SET LOCAL lock_timeout = " + std::to_string(patience_ms) +
                      "; SET LOCAL idle_in_transaction_session_timeout = '8s'" + turn;
  if (version_ > 0) begin += "; SELECT version FROM rigcal.schema_version";
  const PostgresResult version = link_.Begin(begin);
  if (version_ > 0 && PQntuples(version.get()) == 1 && std::atoi(PQgetvalue(version.get(), 0, 0)) > version_) {
    link_.Rollback();
    throw PostgresFailure("a newer rigcal has changed the tables since this process began", kMigratedState);
  }
}

// BEGIN alone takes no snapshot: the first query does.
void PostgresEngine::BeginRead() { link_.Begin("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY; SELECT 1"); }

void PostgresEngine::Commit() { link_.Commit(); }

void PostgresEngine::Rollback() noexcept { link_.Rollback(); }

std::optional<Error> PostgresEngine::ErrorOf(const std::exception& failure, const std::string& subject) const {
  const auto* ours = dynamic_cast<const PostgresFailure*>(&failure);
  return ours == nullptr ? std::nullopt : std::optional(storage::ErrorOf(*ours, subject));
}

SchemaState PostgresEngine::LoadSchemaState() {
  const auto state =
      Prepare("SELECT to_regnamespace('rigcal') IS NULL, to_regclass('rigcal.schema_version') IS NOT NULL");
  if (!state->Step() || state->Int(1) == 0) return {0, false, state->Int(0) != 0};
  const auto version = Prepare("SELECT version FROM rigcal.schema_version");
  version_ = version->Step() ? static_cast<int>(version->Int(0)) : 0;
  return {version_, true, false};
}

void PostgresEngine::RunSchema(std::string_view sql) {
  const SchemaState state = LoadSchemaState();
  if (!state.is_ours) link_.Execute(FileOf("sqlite_functions.sql"));
  link_.Execute(FileOf("later_functions.sql"));
  std::string statements;
  // Until its version is noted, a store is being made.
  for (const std::string& one : PostgresSchemaOf(sql, state.version == 0)) statements += one + ";\n";
  link_.Execute(statements);
}

void PostgresEngine::NoteSchemaVersion(int version) {
  link_.Execute(FileOf("queue_triggers.sql"));
  link_.Execute("UPDATE rigcal.schema_version SET version = " + std::to_string(version));
  version_ = version;
}

void PostgresEngine::CopyIn(const std::string& table, const std::vector<std::string>& columns,
                            const std::vector<StoredRow>& rows) {
  link_.Execute(TriggersOf({table}, "DISABLE"));
  link_.CopyIn("COPY " + table + " (" + Listed(columns) + ") FROM STDIN (FORMAT binary)", CopyDataOf(rows));
  link_.Execute(TriggersOf({table}, "ENABLE"));
}

void PostgresEngine::Empty(const std::vector<std::string>& tables) {
  link_.Execute(TriggersOf(tables, "DISABLE") + "TRUNCATE " + Listed(tables) + "; " + TriggersOf(tables, "ENABLE"));
}

}  // namespace rigcal::storage
