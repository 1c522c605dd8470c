#include "storage/postgres/postgres_link.h"

#include <libpq-fe.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "server/base/log.h"

namespace rigcal::storage {
namespace {

// A store is one schema. A server that is told to answer before a commit is on its disk is told otherwise. Our queries
// are short: compiling them takes longer than they do. The lock of a writer that is cut off is free again after a
// minute.
constexpr const char* kPostgresSettings =
    "SET search_path = rigcal, pg_catalog; SET client_min_messages = warning; SET jit = off; SET "
    "standard_conforming_strings = on; "
    "SET idle_in_transaction_session_timeout = '60s'; "
    "SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'";

std::string TrimmedText(const char* text) {
  std::string trimmed = text == nullptr ? "" : text;
  while (!trimmed.empty() && (trimmed.back() == '\n' || trimmed.back() == ' ')) trimmed.pop_back();
  for (char& c : trimmed)
    if (c == '\n') c = ' ';
  return trimmed;
}

}  // namespace

void PostgresResultEnd::operator()(pg_result* result) const { PQclear(result); }

// A line that falls silent is given up after some 20 s, one that leads to a server on standby at once. What stands
// before "dbname" may be said otherwise in `server`, what stands after it may not.
PostgresLink::PostgresLink(const std::string& server) {
  const std::array<const char*, 10> names = {
      "connect_timeout",  "fallback_application_name", "keepalives_idle", "keepalives_interval", "keepalives_count",
      "tcp_user_timeout", "target_session_attrs",      "dbname",          "client_encoding",     nullptr};
  const std::array<const char*, 10> values = {"10",    "rigcald",    "10",           "5",    "3",
                                              "20000", "read-write", server.c_str(), "UTF8", nullptr};
  connection_ = PQconnectdbParams(names.data(), values.data(), 1);
  try {
    SetUp();
  } catch (const PostgresFailure&) {
    PQfinish(connection_);
    throw;
  }
}

PostgresLink::~PostgresLink() { PQfinish(connection_); }

void PostgresLink::SetUp() {
  is_set_up_ = false;
  if (PQstatus(connection_) != CONNECTION_OK) throw PostgresFailure(TrimmedText(PQerrorMessage(connection_)), "");
  PQsetNoticeProcessor(
      connection_, [](void*, const char* notice) { LogWarn("PostgreSQL: " + TrimmedText(notice)); }, nullptr);
  ++generation_;
  Execute(kPostgresSettings);
  is_set_up_ = true;
}

bool PostgresLink::IsGone() const {
  return !is_in_transaction_ && (!is_set_up_ || PQstatus(connection_) != CONNECTION_OK);
}

void PostgresLink::Revive() {
  if (!IsGone()) return;
  PQreset(connection_);
  SetUp();
}

PostgresResult PostgresLink::Checked(pg_result* result) const {
  PostgresResult owned(result);
  Check(result);
  return owned;
}

void PostgresLink::Check(const pg_result* result) const {
  const ExecStatusType status = PQresultStatus(result);
  if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_EMPTY_QUERY) return;
  const char* state = PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const char* what = PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY);
  throw PostgresFailure(TrimmedText(what == nullptr ? PQerrorMessage(connection_) : what),
                        state == nullptr ? "" : state);
}

PostgresResult PostgresLink::Execute(const std::string& sql) { return Checked(PQexec(connection_, sql.c_str())); }

std::set<std::string> PostgresLink::AwaitNotices(std::chrono::milliseconds time) {
  pollfd ready{PQsocket(connection_), POLLIN, 0};
  const bool came = poll(&ready, 1, static_cast<int>(time.count())) > 0;
  if (came && PQconsumeInput(connection_) == 0) throw PostgresFailure(TrimmedText(PQerrorMessage(connection_)), "");
  std::set<std::string> channels;
  while (PGnotify* notice = PQnotifies(connection_)) {
    channels.insert(notice->relname);
    PQfreemem(notice);
  }
  return channels;
}

void PostgresLink::Prepare(const std::string& name, const std::string& sql, const std::vector<std::uint32_t>& types) {
  Checked(PQprepare(connection_, name.c_str(), sql.c_str(), static_cast<int>(types.size()), types.data()));
}

PostgresResult PostgresLink::Run(const std::string& name, const std::vector<PostgresValue>& values) {
  constexpr int kBinary = 1;
  std::vector<const char*> bytes;
  std::vector<int> sizes;
  for (const PostgresValue& value : values) {
    bytes.push_back(value.type == 0 ? nullptr : value.bytes.data());
    sizes.push_back(static_cast<int>(value.bytes.size()));
  }
  const std::vector<int> formats(values.size(), kBinary);
  return Checked(PQexecPrepared(connection_, name.c_str(), static_cast<int>(values.size()), bytes.data(), sizes.data(),
                                formats.data(), kBinary));
}

// Whatever the server does not like on the way, it says at the end.
void PostgresLink::CopyIn(const std::string& copy, const std::string& data) {
  const PostgresResult begun(PQexec(connection_, copy.c_str()));
  if (PQresultStatus(begun.get()) != PGRES_COPY_IN) Check(begun.get());
  constexpr std::size_t kPieceBytes = 1 << 20;
  bool sent = true;
  for (std::size_t at = 0; sent && at < data.size(); at += kPieceBytes)
    sent = PQputCopyData(connection_, data.data() + at, static_cast<int>(std::min(kPieceBytes, data.size() - at))) == 1;
  if (!sent || PQputCopyEnd(connection_, nullptr) != 1)
    throw PostgresFailure(TrimmedText(PQerrorMessage(connection_)), "");
  const PostgresResult end(PQgetResult(connection_));
  while (pg_result* more = PQgetResult(connection_)) PQclear(more);
  Check(end.get());
}

PostgresResult PostgresLink::Begin(const std::string& begin) {
  return Asked([&] {
    is_in_transaction_ = true;
    try {
      return Execute(begin);
    } catch (const PostgresFailure&) {
      Rollback();
      throw;
    }
  });
}

// A transaction in which something failed is rolled back by COMMIT, and that is no error to the server.
void PostgresLink::Commit() {
  const PostgresResult result = Execute("COMMIT");
  is_in_transaction_ = false;
  if (std::string_view(PQcmdStatus(result.get())) != "COMMIT")
    throw PostgresFailure("the transaction was given up", "40000");
}

void PostgresLink::Rollback() noexcept {
  if (!is_in_transaction_) return;
  is_in_transaction_ = false;
  try {
    Execute("ROLLBACK");
  } catch (const std::exception&) {
    // The connection is gone, and the transaction with it.
  }
}

}  // namespace rigcal::storage
