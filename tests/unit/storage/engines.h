// The database that the tests of a store run on: SQLite in a folder, or a database of its own on the PostgreSQL server
// that tests/postgres/with_postgres started.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "storage/store.h"

namespace rigcal::storage {

[[nodiscard]] bool IsOnSqlite();

// A database of its own on that server, with an empty store or none, gone at the end; on SQLite nothing. `folder`:
// where a store may be.
class TempDatabase {
 public:
  explicit TempDatabase(const std::filesystem::path& folder);
  // Without a store.
  TempDatabase();
  ~TempDatabase();
  TempDatabase(const TempDatabase&) = delete;
  TempDatabase& operator=(const TempDatabase&) = delete;

  [[nodiscard]] StorePlace In(const std::filesystem::path& folder) const;

 private:
  std::string name_;
};

// The first column of a query's rows.
[[nodiscard]] std::vector<std::string> ColumnIn(Store& store, const std::string& sql);
// The first cell of its first row.
[[nodiscard]] std::string TextIn(Store& store, const std::string& sql);
[[nodiscard]] std::int64_t IntIn(Store& store, const std::string& sql);
[[nodiscard]] double RealIn(Store& store, const std::string& sql);

// As somebody would who has all rights on the database: no trigger and no reference is in the way.
void TamperWith(const StorePlace& place, const std::string& sql);

// Bytes, given by their hexadecimal digits, in SQL.
[[nodiscard]] std::string BytesInSql(const std::string& digits);

}  // namespace rigcal::storage
