#include "storage/database/connection.h"

#include <sqlite3.h>

#include <utility>

#include "storage/database/page_sums.h"

namespace rigcal::storage {
namespace {

constexpr int kBusyTimeoutMs = 10'000, kSoonTimeoutMs = 100;

// Without recursive triggers, INSERT OR REPLACE would delete behind the back of the append-only triggers.
constexpr const char* kSettings =
    "PRAGMA synchronous = FULL;"
    "PRAGMA foreign_keys = ON;"
    "PRAGMA recursive_triggers = ON;"
    "PRAGMA trusted_schema = OFF;"
    "PRAGMA cell_size_check = ON;"
    "PRAGMA temp_store = MEMORY;"
    "PRAGMA cache_size = -16384;"
    "PRAGMA journal_size_limit = 67108864;";

Error MisuseOf(const char* what) {
  return {ErrorCode::kInternal, what, "This is a fault of rigcald: please report it."};
}

}  // namespace

Error ErrorOf(const SQLite::Exception& failure, const std::string& subject) {
  const std::string what = subject + ": " + failure.what();
  switch (failure.getErrorCode() & 0xff) {
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      return {ErrorCode::kStorage, what,
              "The database file is damaged: `rigcal fsck` names what is; restore it from a backup, or start with an empty folder."};
    case SQLITE_FULL:
      return {ErrorCode::kStorage, what, "Free some space on the disk."};
    case SQLITE_IOERR:
      return {ErrorCode::kStorage, what, "Check that the disk has free space and is healthy."};
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {ErrorCode::kStorage, what, "Check that the folder exists and that this user may write to it."};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorCode::kBusy, what, "Another process holds the database: wait, or stop it."};
    case SQLITE_TOOBIG:
      return {ErrorCode::kInvalidInput, what, "Send less at once: one value may take up to 1 GB."};
    case SQLITE_CONSTRAINT:
      return {ErrorCode::kConflict, what, "It contradicts what is stored: check the ids that it refers to."};
    default:
      return {ErrorCode::kStorage, what, "Check the disk, and the log of rigcald."};
  }
}

Connection::Connection(const std::filesystem::path& file, std::string name)
    : name_(std::move(name)),
      database_(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kBusyTimeoutMs, SummingFiles()) {
  database_.exec(kSettings);
}

Status Connection::Begin(const char* sql) {
  return Guarded(name_, [&]() -> Status {
    database_.exec(sql);
    return {};
  });
}

Status Connection::Guarded(const std::string& subject, const Body& body) {
  try {
    return body();
  } catch (const SQLite::Exception& failure) {
    Error error = ErrorOf(failure, subject);
    if (state_ == State::kWriting && !doom_) doom_ = error;
    return Fail(std::move(error));
  } catch (const std::exception& failure) {
    Error error{ErrorCode::kInternal, subject + ": " + failure.what(), "This is a fault of rigcald: please report it."};
    if (state_ == State::kWriting && !doom_) doom_ = error;
    return Fail(std::move(error));
  }
}

Status Connection::Commit() {
  if (doom_) return Fail(*doom_);
  return Begin("COMMIT");
}

void Connection::Rollback() {
  // SQLite has already rolled back after some failures (disk full, I/O).
  if (sqlite3_get_autocommit(database_.getHandle()) == 0) database_.tryExec("ROLLBACK");
}

Status Connection::Write(const Body& body) {
  if (state_ != State::kIdle) return Fail(MisuseOf("a write inside another transaction"));
  RIGCAL_TRY(Begin("BEGIN IMMEDIATE"));
  state_ = State::kWriting;
  doom_.reset();
  Status done = Guarded(name_, body);
  if (done) done = Commit();
  if (!done) Rollback();
  state_ = State::kIdle;
  return done;
}

Status Connection::WriteSoon(const Body& body) {
  RIGCAL_TRY(WaitFor(kSoonTimeoutMs));
  Status done = Write(body);
  const Status patient = WaitFor(kBusyTimeoutMs);
  return done ? patient : done;
}

Status Connection::WaitFor(int busy_timeout_ms) {
  return Guarded(name_, [&]() -> Status {
    database_.setBusyTimeout(busy_timeout_ms);
    return {};
  });
}

Status Connection::Read(const Body& body) {
  if (state_ != State::kIdle) return Guarded(name_, body);
  // BEGIN alone takes no snapshot: the first read does.
  Status done = Begin("BEGIN; SELECT 1 FROM sqlite_schema LIMIT 1");
  state_ = State::kReading;
  if (done) done = Guarded(name_, body);
  Rollback();
  state_ = State::kIdle;
  return done;
}

Status Connection::Append(const std::string& subject, const Body& body) {
  if (state_ == State::kReading) return Fail(MisuseOf("a write inside a read"));
  if (state_ == State::kIdle) return Write([&] { return Append(subject, body); });
  if (doom_) return Fail(*doom_);
  return Guarded(subject, body);
}

Status Connection::Load(const std::string& subject, const Body& body) {
  if (doom_ && state_ == State::kWriting) return Fail(*doom_);
  return Guarded(subject, body);
}

}  // namespace rigcal::storage
