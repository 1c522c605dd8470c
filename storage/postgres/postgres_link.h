// The connection to a PostgreSQL server: libpq's, with its results and failures owned. For storage/*.cc only.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

extern "C" {
struct pg_conn;    // libpq's PGconn
struct pg_result;  // PGresult
}

namespace rigcal::storage {

// What PostgreSQL, or the way to it, says.
class PostgresFailure : public std::runtime_error {
 public:
  // `state`: SQLSTATE, five characters; empty: the server did not answer.
  PostgresFailure(const std::string& what, std::string state) : std::runtime_error(what), state_(std::move(state)) {}
  [[nodiscard]] const std::string& state() const { return state_; }

 private:
  std::string state_;
};

struct PostgresResultEnd {
  void operator()(pg_result* result) const;
};
using PostgresResult = std::unique_ptr<pg_result, PostgresResultEnd>;

// A parameter as it is sent: its type, and its bytes in PostgreSQL's binary form.
struct PostgresValue {
  std::uint32_t type = 0;  // 0: NULL
  std::string bytes;
};

class PostgresLink {
 public:
  // `server`: as libpq takes it, "postgresql://user@host/database". Throws PostgresFailure.
  explicit PostgresLink(const std::string& server);
  ~PostgresLink();
  PostgresLink(const PostgresLink&) = delete;
  PostgresLink& operator=(const PostgresLink&) = delete;

  // Connects again where the connection is gone; what was prepared is gone then, too. Within a transaction it does
  // nothing: what is asked next fails.
  void Revive();
  // Outside a transaction `ask` is asked once more over a new connection where the one before turns out to be gone: a
  // server that was restarted is noticed by the first question only. `ask` changes nothing.
  template <typename Ask>
  auto Asked(const Ask& ask) {
    Revive();
    try {
      return ask();
    } catch (const PostgresFailure&) {
      if (!IsGone()) throw;
    }
    Revive();
    return ask();
  }
  // Grows with each connection.
  [[nodiscard]] int generation() const { return generation_; }

  // Names of channels that something was told on (LISTEN) since the last time; waits for the first one so long.
  [[nodiscard]] std::set<std::string> AwaitNotices(std::chrono::milliseconds time);

  // Statements without parameters, as one message. The last one's result.
  PostgresResult Execute(const std::string& sql);
  // `begin`: what begins a transaction, with whatever belongs to that; what its last statement gives. Where it fails
  // there is none.
  PostgresResult Begin(const std::string& begin);
  // Fails where the server gave the transaction up.
  void Commit();
  void Rollback() noexcept;
  // `types`: one for each parameter; 0: the server finds out.
  void Prepare(const std::string& name, const std::string& sql, const std::vector<std::uint32_t>& types);
  [[nodiscard]] PostgresResult Run(const std::string& name, const std::vector<PostgresValue>& values);
  // What `copy`, a COPY ... FROM STDIN, reads.
  void CopyIn(const std::string& copy, const std::string& data);
  [[nodiscard]] std::string NewName() { return "s" + std::to_string(++names_); }

 private:
  void SetUp();
  // Outside a transaction.
  [[nodiscard]] bool IsGone() const;
  PostgresResult Checked(pg_result* result) const;
  void Check(const pg_result* result) const;

  pg_conn* connection_ = nullptr;
  bool is_set_up_ = false;
  bool is_in_transaction_ = false;  // by Begin, whatever became of the connection since
  int generation_ = 0, names_ = 0;
};

}  // namespace rigcal::storage
