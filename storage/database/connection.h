// One SQLite connection behind a Store: transactions, prepared statements, errors in words. For storage/*.cc only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/base/result.h"

namespace rigcal::storage {

// What SQLite said, as one sentence about `subject` ("the store at FOLDER", "edge ... of robot ...") and its cure.
[[nodiscard]] Error ErrorOf(const SQLite::Exception& failure, const std::string& subject);

class Connection {
 public:
  using Body = std::function<Status()>;

  // Throws SQLite::Exception.
  Connection(const std::filesystem::path& file, std::string name);

  [[nodiscard]] SQLite::Database& database() { return database_; }  // for storage/*.cc only

  // Where the prepared statement of `sql` waits while nobody runs it; null at first.
  [[nodiscard]] std::unique_ptr<SQLite::Statement>& IdleStatement(const std::string& sql) {
    return idle_statements_[sql];
  }

  // The transactions of store.h.
  [[nodiscard]] Status Write(const Body& body);
  [[nodiscard]] Status WriteSoon(const Body& body);
  [[nodiscard]] Status Read(const Body& body);
  // Runs `body` in the Write that is under way, or in one of its own. A body checks all its input before it writes:
  // then whoever goes on after its error has no half of it. A failure of SQLite instead dooms the whole Write.
  [[nodiscard]] Status Append(const std::string& subject, const Body& body);
  // Runs `body`; in no transaction, each statement sees the newest state.
  [[nodiscard]] Status Load(const std::string& subject, const Body& body);

 private:
  enum class State { kIdle, kReading, kWriting };

  [[nodiscard]] Status Begin(const char* sql);
  [[nodiscard]] Status WaitFor(int busy_timeout_ms);
  [[nodiscard]] Status Guarded(const std::string& subject, const Body& body);
  [[nodiscard]] Status Commit();
  void Rollback();

  std::string name_;
  SQLite::Database database_;
  std::unordered_map<std::string, std::unique_ptr<SQLite::Statement>> idle_statements_;  // by SQL
  State state_ = State::kIdle;
  std::optional<Error> doom_;  // the first failure of SQLite in the Write under way
};

}  // namespace rigcal::storage
