// One run of a prepared statement, for storage/*.cc only: bound by position in one go, reset at the end of its scope
// and kept by the connection for the next run. Throws what its engine throws; Connection::Append and Load catch it.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/math/tangent.h"
#include "storage/database/connection.h"
#include "storage/database/stored_row.h"
#include "storage/store.h"

namespace rigcal::storage {

static_assert(std::endian::native == std::endian::little, "BLOBs hold little-endian doubles");

// The doubles as they lie in memory; a matrix row by row.
[[nodiscard]] Blob BlobOf(const double* values, std::size_t count);
[[nodiscard]] Blob BlobOf(const Matrix6d& matrix);

class Query {
 public:
  // Takes the statement of `sql` that the connection keeps, or prepares it.
  Query(Store& store, const std::string& sql);
  Query(Connection& connection, const std::string& sql);
  ~Query();
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  // The next parameters, from the first: what is absent becomes NULL, an id its text, a stamp its nanoseconds.
  template <typename... Values>
  Query& Bind(const Values&... values) {
    (BindOne(values), ...);
    return *this;
  }
  // Large text: must outlive the query.
  Query& BindNoCopy(const std::string& text);

  // To the next row; false after the last one.
  [[nodiscard]] bool Step() { return statement_->Step(); }
  // Runs it to the end; the number of rows changed.
  int Run() { return statement_->Run(); }
  // Runs an INSERT that ends in RETURNING and the key: that of its row; nothing where ON CONFLICT left the row away.
  [[nodiscard]] std::optional<std::int64_t> RunForKey();

  // Of the row that Step() came to; columns count from 0. NULL reads as 0 or empty text.
  [[nodiscard]] bool IsNull(int column) const { return statement_->IsNull(column); }
  [[nodiscard]] std::int64_t Int(int column) const { return statement_->Int(column); }
  [[nodiscard]] double Real(int column) const { return statement_->Real(column); }
  [[nodiscard]] std::string Text(int column) const { return std::string(statement_->Bytes(column)); }
  [[nodiscard]] Stamp Time(int column) const { return {Int(column)}; }
  template <typename AnId>
  [[nodiscard]] AnId IdAt(int column) const {
    return AnId(Text(column));
  }
  // Throws if the blob's size is no whole number of doubles.
  [[nodiscard]] std::vector<double> Doubles(int column) const;
  // Throws if it is not a 6x6.
  [[nodiscard]] Matrix6d MatrixAt(int column) const;

 private:
  void BindOne(std::int64_t value) { statement_->Bind(++bound_, value); }
  void BindOne(int value) { BindOne(static_cast<std::int64_t>(value)); }
  void BindOne(std::uint32_t value) { BindOne(static_cast<std::int64_t>(value)); }
  void BindOne(std::size_t value) { BindOne(static_cast<std::int64_t>(value)); }
  void BindOne(const char*) = delete;  // would be taken for a bool
  void BindOne(bool value) { BindOne(static_cast<std::int64_t>(value ? 1 : 0)); }
  void BindOne(double value) { statement_->Bind(++bound_, value); }
  void BindOne(const std::string& value) { statement_->BindText(++bound_, value); }
  void BindOne(const Blob& value) { statement_->BindBlob(++bound_, value.bytes); }
  void BindOne(Stamp value) { BindOne(value.ns); }
  void BindOne(std::nullopt_t) { ++bound_; }
  template <typename Tag>
  void BindOne(const Id<Tag>& value) {
    BindOne(value.str());
  }
  template <typename T>
  void BindOne(const std::optional<T>& value) {
    value ? BindOne(*value) : BindOne(std::nullopt);
  }

  std::unique_ptr<EngineStatement>& idle_;  // its place in the connection
  std::unique_ptr<EngineStatement> statement_;
  int bound_ = 0;
};

// As json_each takes it; ids hold no character that JSON escapes.
template <typename Tag>
[[nodiscard]] std::string ListOf(const std::vector<Id<Tag>>& ids) {
  std::string list = "[";
  for (const Id<Tag>& id : ids) list += (list.size() == 1 ? "\"" : ",\"") + id.str() + "\"";
  return list + "]";
}

// Of numbers, likewise.
template <std::integral Number>
[[nodiscard]] std::string ListOf(const std::vector<Number>& numbers) {
  std::string list = "[";
  for (const Number number : numbers) list += (list.size() == 1 ? "" : ",") + std::to_string(number);
  return list + "]";
}

// NULL for an empty id.
template <typename Tag>
[[nodiscard]] std::optional<Id<Tag>> NullIfEmpty(const Id<Tag>& id) {
  return id.empty() ? std::nullopt : std::optional(id);
}

// Load with a value: `body` returns Result<T>.
template <typename T, typename Body>
[[nodiscard]] Result<T> Load(Store& store, const std::string& subject, const Body& body) {
  Result<T> answer = Fail(ErrorCode::kInternal, subject, "This is a fault of rigcald: please report it.");
  RIGCAL_TRY(store.connection().Load(subject, [&]() -> Status {
    answer = body();
    return {};
  }));
  return answer;
}

// Append with a value.
template <typename T, typename Body>
[[nodiscard]] Result<T> Append(Store& store, const std::string& subject, const Body& body) {
  T answer{};
  RIGCAL_TRY(store.connection().Append(subject, [&]() -> Status {
    RIGCAL_ASSIGN(answer, body());
    return {};
  }));
  return answer;
}

}  // namespace rigcal::storage
