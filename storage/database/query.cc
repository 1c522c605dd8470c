#include "storage/database/query.h"

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

Query::Query(Store& store, const std::string& sql) : Query(store.connection(), sql) {}

Query::Query(Connection& connection, const std::string& sql)
    : idle_(connection.IdleStatement(sql)), statement_(std::move(idle_)) {
  if (!statement_) statement_ = connection.engine().Prepare(sql);
}

Query::~Query() {
  try {
    statement_->Reset();
    idle_ = std::move(statement_);
  } catch (const std::exception&) {
    // The next run prepares it anew.
  }
}

Query& Query::BindNoCopy(const std::string& text) {
  statement_->BindTextNoCopy(++bound_, text);
  return *this;
}

std::optional<std::int64_t> Query::RunForKey() { return Step() ? std::optional(Int(0)) : std::nullopt; }

std::vector<double> Query::Doubles(int column) const {
  const std::string_view bytes = statement_->Bytes(column);
  if (bytes.size() % sizeof(double) != 0) throw StoredWrong("a stored vector is cut short");
  std::vector<double> values(bytes.size() / sizeof(double));
  if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

Matrix6d Query::MatrixAt(int column) const {
  const std::vector<double> values = Doubles(column);
  if (values.size() != 36) throw StoredWrong("a stored matrix is not 6 x 6");
  return Eigen::Map<const RowMajor6d>(values.data());
}

}  // namespace rigcal::storage
