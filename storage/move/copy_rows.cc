#include "storage/move/copy_rows.h"

#include "server/base/digests/sha256.h"
#include "storage/move/row_reader.h"

namespace rigcal::storage {
namespace {

Result<std::int64_t> CountAll(Connection& connection, const std::vector<SchemaTable>& tables) {
  std::int64_t count = 0;
  for (const SchemaTable& table : tables) {
    RIGCAL_ASSIGN(const std::int64_t of_table, CountRows(connection, table));
    count += of_table;
  }
  return count;
}

struct Progressed {
  const RowProgress& progress;
  std::int64_t done, total;
  void Add(std::size_t rows) { progress(done += static_cast<std::int64_t>(rows), total); }
};

Status CopyTable(Connection& from, Connection& to, const SchemaTable& table, Progressed& progressed) {
  RIGCAL_ASSIGN(auto after, LoadGreatestKey(to, table));
  RowReader reader(from, table, std::move(after));
  const std::vector<std::string> columns = table.ColumnNames();
  while (true) {
    RIGCAL_ASSIGN(const auto rows, reader.NextRows());
    if (rows.empty()) return {};
    RIGCAL_TRY(to.Append("the copy of the table " + table.name, [&]() -> Status {
      to.engine().CopyIn(table.name, columns, rows);
      return {};
    }));
    progressed.Add(rows.size());
  }
}

Error DiffersError(const SchemaTable& table, const StoredRow& row) {
  return {ErrorCode::kConflict,
          "the row " + TextOfKey(KeyOf(table, row)) + " of the table " + table.name +
              " is not the same in the store and in its copy",
          "Nothing was changed in the store; remove the copy, and begin anew."};
}

Status CompareTable(Connection& from, Connection& to, const SchemaTable& table, Progressed& progressed) {
  RowReader originals(from, table), copies(to, table);
  while (true) {
    RIGCAL_ASSIGN(const StoredRow* const original, originals.Next());
    RIGCAL_ASSIGN(const StoredRow* const copy, copies.Next());
    if (original == nullptr && copy == nullptr) return {};
    if (original == nullptr || copy == nullptr || *original != *copy)
      return Fail(DiffersError(table, original != nullptr ? *original : *copy));
    progressed.Add(1);
  }
}

}  // namespace

Result<Digest> FingerprintOf(Connection& from, const std::vector<SchemaTable>& tables) {
  Sha256 hash;
  for (const SchemaTable& table : tables) {
    RIGCAL_ASSIGN(const std::int64_t count, CountRows(from, table));
    RIGCAL_ASSIGN(const auto greatest, LoadGreatestKey(from, table));
    hash.Add(table.name + ":" + std::to_string(count) + ":" + (greatest ? TextOfKey(*greatest) : "") + "\n");
  }
  return hash.Finish();
}

Status CopyRows(Connection& from, Connection& to, const std::vector<SchemaTable>& tables, const RowProgress& progress) {
  RIGCAL_ASSIGN(const std::int64_t total, CountAll(from, tables));
  RIGCAL_ASSIGN(const std::int64_t there, CountAll(to, tables));
  Progressed progressed{progress, there, total};
  for (const SchemaTable& table : tables) RIGCAL_TRY(CopyTable(from, to, table, progressed));
  return {};
}

Result<std::int64_t> CompareRows(Connection& from, Connection& to, const std::vector<SchemaTable>& tables,
                                 const RowProgress& progress) {
  RIGCAL_ASSIGN(const std::int64_t total, CountAll(from, tables));
  Progressed progressed{progress, 0, total};
  for (const SchemaTable& table : tables) RIGCAL_TRY(CompareTable(from, to, table, progressed));
  return total;
}

}  // namespace rigcal::storage
