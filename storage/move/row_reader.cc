#include "storage/move/row_reader.h"

#include <algorithm>

#include "storage/database/query.h"

namespace rigcal::storage {
namespace {

constexpr std::size_t kBatchBytes = 4 << 20;
constexpr std::int64_t kBatchRowsMin = 16, kBatchRowsMax = 4096;

std::string NamesOf(const SchemaTable& table, const std::vector<std::size_t>& columns, const std::string& after = "") {
  std::string names;
  for (const std::size_t column : columns) names += (names.empty() ? "" : ", ") + table.columns[column].name + after;
  return names;
}

StoredCell CellAt(const Query& query, int column, ColumnKind kind) {
  if (query.IsNull(column)) return {};
  switch (kind) {
    case ColumnKind::kWhole:
      return query.Int(column);
    case ColumnKind::kReal:
      return query.Real(column);
    case ColumnKind::kText:
      return query.Text(column);
    case ColumnKind::kBytes:
      break;
  }
  return Blob{query.Text(column)};
}

std::size_t BytesOf(const StoredRow& row) {
  std::size_t bytes = 0;
  for (const StoredCell& cell : row) {
    bytes += sizeof(std::int64_t);
    if (const auto* text = std::get_if<std::string>(&cell)) bytes += text->size();
    if (const auto* blob = std::get_if<Blob>(&cell)) bytes += blob->bytes.size();
  }
  return bytes;
}

void BindRow(Query& query, const StoredRow& row) {
  for (const StoredCell& cell : row) {
    if (const auto* whole = std::get_if<std::int64_t>(&cell)) query.Bind(*whole);
    if (const auto* text = std::get_if<std::string>(&cell)) query.Bind(*text);
  }
}

std::string SubjectOf(const SchemaTable& table) { return "the table " + table.name; }

}  // namespace

StoredRow KeyOf(const SchemaTable& table, const StoredRow& row) {
  StoredRow key;
  for (const std::size_t column : table.key) key.push_back(row[column]);
  return key;
}

std::string TextOfKey(const StoredRow& key) {
  std::string text;
  for (const StoredCell& cell : key) {
    const auto* whole = std::get_if<std::int64_t>(&cell);
    const auto* words = std::get_if<std::string>(&cell);
    text += (text.empty() ? "" : ", ") + (whole != nullptr ? std::to_string(*whole) : words != nullptr ? *words : "");
  }
  return text;
}

Result<std::optional<StoredRow>> LoadGreatestKey(Connection& connection, const SchemaTable& table) {
  std::optional<StoredRow> key;
  RIGCAL_TRY(connection.Load(SubjectOf(table), [&]() -> Status {
    Query query(connection, "SELECT " + NamesOf(table, table.key) + " FROM " + table.name + " ORDER BY " +
                                NamesOf(table, table.key, " DESC") + " LIMIT 1");
    if (!query.Step()) return {};
    key.emplace();
    for (std::size_t at = 0; at < table.key.size(); ++at)
      key->push_back(CellAt(query, static_cast<int>(at), table.columns[table.key[at]].kind));
    return {};
  }));
  return key;
}

Result<std::int64_t> CountRows(Connection& connection, const SchemaTable& table) {
  std::int64_t count = 0;
  RIGCAL_TRY(connection.Load(SubjectOf(table), [&]() -> Status {
    Query query(connection, "SELECT count(*) FROM " + table.name);
    count = query.Step() ? query.Int(0) : 0;
    return {};
  }));
  return count;
}

std::string RowReader::Sql() const {
  std::string columns, places;
  for (const std::string& name : table_.ColumnNames()) columns += (columns.empty() ? "" : ", ") + name;
  for (std::size_t at = 0; at < table_.key.size(); ++at) places += at == 0 ? "?" : ", ?";
  const std::string key = NamesOf(table_, table_.key);
  return "SELECT " + columns + " FROM " + table_.name +
         (after_ ? " WHERE (" + key + ") > (" + places + ")" : std::string()) + " ORDER BY " + key + " LIMIT ?";
}

// One engine gives all the rows that were asked for at once.
void RowReader::SetLimit(std::size_t bytes, std::size_t rows) {
  const auto of_this_size = static_cast<std::int64_t>(kBatchBytes / std::max<std::size_t>(bytes / rows, 1));
  limit_ = std::clamp(of_this_size, kBatchRowsMin, std::min(kBatchRowsMax, 4 * limit_));
}

Result<std::vector<StoredRow>> RowReader::NextRows() {
  std::vector<StoredRow> rows;
  RIGCAL_TRY(connection_.Load(SubjectOf(table_), [&]() -> Status {
    Query query(connection_, Sql());
    if (after_) BindRow(query, *after_);
    query.Bind(limit_);
    std::size_t bytes = 0;
    while (bytes < 2 * kBatchBytes && query.Step()) {
      StoredRow& row = rows.emplace_back();
      for (std::size_t at = 0; at < table_.columns.size(); ++at)
        row.push_back(CellAt(query, static_cast<int>(at), table_.columns[at].kind));
      bytes += BytesOf(row);
    }
    if (!rows.empty()) SetLimit(bytes, rows.size());
    return {};
  }));
  if (!rows.empty()) after_ = KeyOf(table_, rows.back());
  return rows;
}

Result<const StoredRow*> RowReader::Next() {
  if (next_ == rows_.size()) {
    RIGCAL_ASSIGN(rows_, NextRows());
    next_ = 0;
  }
  return rows_.empty() ? nullptr : &rows_[next_++];
}

}  // namespace rigcal::storage
