// SQLite, in one file of this machine. For storage/*.cc only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <filesystem>
#include <memory>
#include <string>

#include "storage/database/engine.h"

namespace rigcal::storage {

// What SQLite said, as one sentence about `subject` ("the store at FOLDER", "edge ... of robot ...") and its cure.
[[nodiscard]] Error ErrorOf(const SQLite::Exception& failure, const std::string& subject);

// It lies on a disk that is mounted read-only, and no log is left beside it: all of it is in the file.
[[nodiscard]] bool CannotChange(const std::filesystem::path& file);
// How SQLite opens such a file, with OPEN_URI: else it would want to make files beside it.
[[nodiscard]] std::string UnchangingName(const std::filesystem::path& file);

class SqliteEngine : public Engine {
 public:
  // Opens or creates it; one that cannot change only to be read. Throws SQLite::Exception.
  explicit SqliteEngine(const std::filesystem::path& file);

  [[nodiscard]] SQLite::Database& database() { return database_; }

  [[nodiscard]] std::unique_ptr<EngineStatement> Prepare(const std::string& sql) override;
  void BeginWrite() override;
  void BeginRead() override;
  void Commit() override;
  void Rollback() noexcept override;
  void SetPatience(int milliseconds) override;
  [[nodiscard]] std::optional<Error> ErrorOf(const std::exception& failure, const std::string& subject) const override;
  [[nodiscard]] SchemaState LoadSchemaState() override;
  void PrepareDatabase() override;
  [[nodiscard]] bool TakesWholeSchema() const override { return true; }
  void RunSchema(std::string_view sql) override;
  void NoteSchemaVersion(int version) override;
  void CopyIn(const std::string& table, const std::vector<std::string>& columns,
              const std::vector<StoredRow>& rows) override;
  void Empty(const std::vector<std::string>& tables) override;

 private:
  [[nodiscard]] int Pragma(const char* name);

  SQLite::Database database_;
};

}  // namespace rigcal::storage
