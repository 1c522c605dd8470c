// What keeps the rows of a store, SQLite or PostgreSQL, as the rest of storage/ sees it. For storage/*.cc only.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "storage/database/stored_row.h"

namespace rigcal::storage {

// How long a write waits for the one before, unless it is told otherwise.
inline constexpr int kPatience_ms = 10'000;

// A stored value is not what its column holds.
struct StoredWrong : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A prepared statement. All of it throws the engine's own exception (Engine::ErrorOf says what it means).
class EngineStatement {
 public:
  EngineStatement() = default;
  virtual ~EngineStatement() = default;
  EngineStatement(const EngineStatement&) = delete;
  EngineStatement& operator=(const EngineStatement&) = delete;

  // Parameters count from 1; those that were not bound since Reset() are NULL. A NaN is NULL, -0.0 is 0.0.
  virtual void Bind(int at, std::int64_t value) = 0;
  virtual void Bind(int at, double value) = 0;
  virtual void BindText(int at, const std::string& text) = 0;
  virtual void BindTextNoCopy(int at, const std::string& text) = 0;  // must live until Reset()
  virtual void BindBlob(int at, std::string_view bytes) = 0;

  // To the next row; false after the last one.
  [[nodiscard]] virtual bool Step() = 0;
  // Of a statement without rows: runs it; the number of rows changed.
  virtual int Run() = 0;
  // Ready for another run.
  virtual void Reset() = 0;

  // Of the row that Step() came to; columns count from 0. NULL reads as 0 or nothing.
  [[nodiscard]] virtual bool IsNull(int column) const = 0;
  [[nodiscard]] virtual std::int64_t Int(int column) const = 0;
  [[nodiscard]] virtual double Real(int column) const = 0;
  // A text, or the bytes of a blob; until the next Step().
  [[nodiscard]] virtual std::string_view Bytes(int column) const = 0;
};

// What a database says of itself.
struct SchemaState {
  int version = 0;  // how many files of storage/schema it has
  bool is_ours = false, is_empty = false;
};

// One connection; one thread at a time.
class Engine {
 public:
  Engine() = default;
  virtual ~Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  // `sql`: what both engines understand (storage/README.md), with ? or ?1 where a parameter is.
  [[nodiscard]] virtual std::unique_ptr<EngineStatement> Prepare(const std::string& sql) = 0;

  // One writer at a time: waits for the one before, as long as SetPatience says.
  virtual void BeginWrite() = 0;
  // For rows that nothing is numbered by and that are changed one by one: waits for who changes the same row only,
  // where the engine can.
  virtual void BeginWriteBeside() { BeginWrite(); }
  // One snapshot, taken now.
  virtual void BeginRead() = 0;
  // Durable when it returns.
  virtual void Commit() = 0;
  // Whatever is under way, if anything.
  virtual void Rollback() noexcept = 0;
  virtual void SetPatience(int milliseconds) = 0;

  // Of an exception of this engine, as one sentence about `subject` and its cure; nothing of any other.
  [[nodiscard]] virtual std::optional<Error> ErrorOf(const std::exception& failure,
                                                     const std::string& subject) const = 0;

  // Of the database as it is, also of one that is no store of ours.
  [[nodiscard]] virtual SchemaState LoadSchemaState() = 0;
  // Before anything else of a store: settings that stay with the database.
  virtual void PrepareDatabase() = 0;
  // Whether a store may be made by one script in the dialect of storage/schema instead of by its files one by one.
  [[nodiscard]] virtual bool TakesWholeSchema() const { return false; }
  // A whole file of storage/schema.
  virtual void RunSchema(std::string_view sql) = 0;
  virtual void NoteSchemaVersion(int version) = 0;

  // Both within a write. Rows as another store has them, each in the order of `columns`: references are held to, no
  // trigger runs.
  virtual void CopyIn(const std::string& table, const std::vector<std::string>& columns,
                      const std::vector<StoredRow>& rows) = 0;
  // Takes every row of these tables, of which each refers to tables before it only; no trigger runs.
  virtual void Empty(const std::vector<std::string>& tables) = 0;
};

}  // namespace rigcal::storage
