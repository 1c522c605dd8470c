#include "storage/database/query.h"

#include <sqlite3.h>

#include <utility>

namespace rigcal::storage {
namespace {

using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

}  // namespace

Blob BlobOf(const double* values, std::size_t count) {
  Blob blob{std::string(count * sizeof(double), '\0')};
  if (count > 0) std::memcpy(blob.bytes.data(), values, blob.bytes.size());
  return blob;
}

Blob BlobOf(const Matrix6d& matrix) {
  const RowMajor6d rows = matrix;
  return BlobOf(rows.data(), 36);
}

std::string ListOf(const std::vector<int>& numbers) {
  std::string list = "[";
  for (const int number : numbers) list += (list.size() == 1 ? "" : ",") + std::to_string(number);
  return list + "]";
}

Query::Query(Store& store, const std::string& sql)
    : idle_(store.connection().IdleStatement(sql)), statement_(std::move(idle_)) {
  if (!statement_) statement_ = std::make_unique<SQLite::Statement>(store.connection().database(), sql);
}

Query::~Query() {
  statement_->tryReset();
  try {
    statement_->clearBindings();
    idle_ = std::move(statement_);
  } catch (const SQLite::Exception&) {
    // The next run prepares it anew.
  }
}

Query& Query::BindNoCopy(const std::string& text) {
  statement_->bindNoCopy(++bound_, text);
  return *this;
}

std::vector<double> Query::Doubles(int column) const {
  const SQLite::Column cell = statement_->getColumn(column);
  const std::size_t bytes = static_cast<std::size_t>(cell.getBytes());
  if (bytes % sizeof(double) != 0) throw SQLite::Exception("a stored vector is cut short", SQLITE_CORRUPT);
  std::vector<double> values(bytes / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), cell.getBlob(), bytes);
  return values;
}

Matrix6d Query::MatrixAt(int column) const {
  const std::vector<double> values = Doubles(column);
  if (values.size() != 36) throw SQLite::Exception("a stored matrix is not 6 x 6", SQLITE_CORRUPT);
  return Eigen::Map<const RowMajor6d>(values.data());
}

}  // namespace rigcal::storage
