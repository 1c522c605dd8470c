// One connection behind a Store: transactions, prepared statements, errors in words. For storage/*.cc only.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>

#include "server/base/result.h"
#include "storage/database/engine.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): the name is the library's
class Database;
}

namespace rigcal::storage {

class Connection {
 public:
  using Body = std::function<Status()>;

  Connection(std::unique_ptr<Engine> engine, std::string name);
  // With SQLite. Throws SQLite::Exception.
  Connection(const std::filesystem::path& file, std::string name);

  [[nodiscard]] Engine& engine() { return *engine_; }
  // Of SQLite only (storage/upkeep); throws std::bad_cast where it is another engine.
  [[nodiscard]] SQLite::Database& database();

  // Where the prepared statement of `sql` waits while nobody runs it; null at first.
  [[nodiscard]] std::unique_ptr<EngineStatement>& IdleStatement(const std::string& sql) {
    return idle_statements_[sql];
  }

  // From here on every Write begins with this, and fails where it does; an empty one: no more.
  void SetGuard(Body guard) { guard_ = std::move(guard); }

  // The transactions of store.h.
  [[nodiscard]] Status Write(const Body& body) { return Write(&Engine::BeginWrite, body); }
  [[nodiscard]] Status WriteSoon(const Body& body);
  // Like Write, but beside whoever writes (Engine::BeginWriteBeside): what must not wait for its turn.
  [[nodiscard]] Status WriteBeside(const Body& body) { return Write(&Engine::BeginWriteBeside, body); }
  [[nodiscard]] Status Read(const Body& body);
  // Runs `body` in the Write that is under way, or in one of its own. A body checks all its input before it writes:
  // then whoever goes on after its error has no half of it. A failure of the engine instead dooms the whole Write.
  [[nodiscard]] Status Append(const std::string& subject, const Body& body);
  // Runs `body`; in no transaction, each statement sees the newest state.
  [[nodiscard]] Status Load(const std::string& subject, const Body& body);

 private:
  enum class State { kIdle, kReading, kWriting };
  class Ending;

  [[nodiscard]] Status Run(void (Engine::*step)());
  [[nodiscard]] Status Write(void (Engine::*begin)(), const Body& body);
  [[nodiscard]] Status WaitFor(int milliseconds);
  [[nodiscard]] Status Guarded(const std::string& subject, const Body& body);
  [[nodiscard]] Error ErrorOf(const std::exception& failure, const std::string& subject) const;
  [[nodiscard]] Status Commit();

  std::string name_;
  std::unique_ptr<Engine> engine_;
  std::unordered_map<std::string, std::unique_ptr<EngineStatement>> idle_statements_;  // by SQL; gone before the engine
  Body guard_;
  State state_ = State::kIdle;
  std::optional<Error> doom_;  // the first failure of the engine in the Write under way
};

}  // namespace rigcal::storage
