// PostgreSQL 15 or newer, by libpq. For storage/*.cc only.
#pragma once

#include <memory>
#include <string>

#include "storage/database/engine.h"
#include "storage/postgres/postgres_link.h"

namespace rigcal::storage {

// What PostgreSQL said, as one sentence about `subject` and its cure.
[[nodiscard]] Error ErrorOf(const PostgresFailure& failure, const std::string& subject);

// One writer of a store at a time, by an advisory lock: what is numbered as it comes is numbered in the order in which
// it is committed, as in SQLite.
class PostgresEngine : public Engine {
 public:
  // `server`: as libpq takes it. Throws PostgresFailure.
  explicit PostgresEngine(const std::string& server) : link_(server) {}

  [[nodiscard]] std::unique_ptr<EngineStatement> Prepare(const std::string& sql) override;
  void BeginWrite() override;
  void BeginWriteBeside() override;
  void BeginRead() override;
  void Commit() override;
  void Rollback() noexcept override;
  void SetPatience(int milliseconds) override { patience_ms_ = milliseconds; }
  [[nodiscard]] std::optional<Error> ErrorOf(const std::exception& failure, const std::string& subject) const override;
  [[nodiscard]] SchemaState LoadSchemaState() override;
  void PrepareDatabase() override {}
  void RunSchema(std::string_view sql) override;
  void NoteSchemaVersion(int version) override;
  void CopyIn(const std::string& table, const std::vector<std::string>& columns,
              const std::vector<StoredRow>& rows) override;
  void Empty(const std::vector<std::string>& tables) override;

 private:
  void BeginWith(const std::string& turn);

  PostgresLink link_;
  int patience_ms_ = kPatience_ms;
  int version_ = 0;  // of the tables, as far as this connection knows; 0: there are none yet
};

}  // namespace rigcal::storage
