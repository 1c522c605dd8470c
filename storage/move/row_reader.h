// The rows of a table, whichever engine has them, as they are. For storage/*.cc only.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/database/connection.h"
#include "storage/move/schema_tables.h"

namespace rigcal::storage {

// The cells of the key.
[[nodiscard]] StoredRow KeyOf(const SchemaTable& table, const StoredRow& row);
// For people: "mapper-01, 3".
[[nodiscard]] std::string TextOfKey(const StoredRow& key);
// Nothing: there is no row.
[[nodiscard]] Result<std::optional<StoredRow>> LoadGreatestKey(Connection& connection, const SchemaTable& table);
[[nodiscard]] Result<std::int64_t> CountRows(Connection& connection, const SchemaTable& table);

// In the order of the key. What it reads must stay as it is meanwhile.
class RowReader {
 public:
  // From the first row whose key is greater than `after` on. Both must live as long.
  RowReader(Connection& connection, const SchemaTable& table, std::optional<StoredRow> after = {})
      : connection_(connection), table_(table), after_(std::move(after)) {}

  // The next ones, as many as take some megabytes; none: that was all.
  [[nodiscard]] Result<std::vector<StoredRow>> NextRows();
  // The same one by one; null after the last one.
  [[nodiscard]] Result<const StoredRow*> Next();

 private:
  [[nodiscard]] std::string Sql() const;
  void SetLimit(std::size_t bytes, std::size_t rows);

  Connection& connection_;
  const SchemaTable& table_;
  std::optional<StoredRow> after_;
  std::int64_t limit_ = 64;  // of a question: grows where rows are small
  std::vector<StoredRow> rows_;
  std::size_t next_ = 0;  // in rows_
};

}  // namespace rigcal::storage
