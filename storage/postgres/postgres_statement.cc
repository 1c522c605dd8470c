#include "storage/postgres/postgres_statement.h"

#include <libpq-fe.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "storage/postgres/postgres_copy.h"

namespace rigcal::storage {
namespace {

// Of PostgreSQL's catalog, where they never change.
constexpr std::uint32_t kBoolType = 16, kBytesType = 17, kInt8Type = 20, kInt2Type = 21, kInt4Type = 23, kTextType = 25,
                        kFloat8Type = 701;

std::uint64_t FromBigEndian(std::string_view bytes) {
  std::uint64_t bits = 0;
  for (const char byte : bytes) bits = bits << 8 | static_cast<unsigned char>(byte);
  return bits;
}

// Of two, four or eight bytes, or one: a truth.
std::int64_t WholeNumberOf(std::string_view bytes) {
  const std::uint64_t bits = FromBigEndian(bytes);
  if (bytes.size() == 2) return static_cast<std::int16_t>(bits);
  return bytes.size() == 4 ? static_cast<std::int32_t>(bits) : static_cast<std::int64_t>(bits);
}

bool IsWholeNumber(std::uint32_t type) {
  return type == kBoolType || type == kInt2Type || type == kInt4Type || type == kInt8Type;
}

StoredWrong WrongType(std::uint32_t type) {
  return StoredWrong("a column has the unexpected type " + std::to_string(type));
}

}  // namespace

void PostgresStatement::Clear() {
  values_.assign(static_cast<std::size_t>(query_.parameters), {});
  result_.reset();
  row_ = -1;
}

void PostgresStatement::Bind(int at, std::int64_t value) {
  values_.at(static_cast<std::size_t>(at - 1)) = {kInt8Type, BigEndianOf(static_cast<std::uint64_t>(value), 8)};
}

void PostgresStatement::Bind(int at, double value) {
  if (std::isnan(value)) return;
  values_.at(static_cast<std::size_t>(at - 1)) = {kFloat8Type,
                                                  BigEndianOf(std::bit_cast<std::uint64_t>(value + 0.0), 8)};
}

void PostgresStatement::BindText(int at, const std::string& text) {
  values_.at(static_cast<std::size_t>(at - 1)) = {kTextType, text};
}

void PostgresStatement::BindBlob(int at, std::string_view bytes) {
  values_.at(static_cast<std::size_t>(at - 1)) = {kBytesType, std::string(bytes)};
}

const std::string& PostgresStatement::PreparedName() {
  std::vector<std::uint32_t> types;
  for (const PostgresValue& value : values_) types.push_back(value.type);
  Prepared& prepared = prepared_[types];
  if (prepared.generation != link_.generation()) {
    prepared.name = link_.NewName();
    link_.Prepare(prepared.name, query_.sql, types);
    prepared.generation = link_.generation();
  }
  return prepared.name;
}

void PostgresStatement::Execute() {
  // Outside a transaction only what is read is asked.
  result_ = link_.Asked([&] { return link_.Run(PreparedName(), values_); });
  row_ = -1;
}

bool PostgresStatement::Step() {
  if (!result_) Execute();
  return ++row_ < PQntuples(result_.get());
}

int PostgresStatement::Run() {
  Execute();
  return static_cast<int>(std::strtol(PQcmdTuples(result_.get()), nullptr, 10));
}

std::string_view PostgresStatement::Raw(int column) const {
  return {PQgetvalue(result_.get(), row_, column), static_cast<std::size_t>(PQgetlength(result_.get(), row_, column))};
}

bool PostgresStatement::IsNull(int column) const { return PQgetisnull(result_.get(), row_, column) == 1; }

std::int64_t PostgresStatement::Int(int column) const {
  if (IsNull(column)) return 0;
  const std::uint32_t type = PQftype(result_.get(), column);
  if (IsWholeNumber(type)) return WholeNumberOf(Raw(column));
  if (type == kTextType) return std::strtoll(std::string(Raw(column)).c_str(), nullptr, 10);
  throw WrongType(type);
}

double PostgresStatement::Real(int column) const {
  if (IsNull(column)) return 0.0;
  const std::uint32_t type = PQftype(result_.get(), column);
  if (type == kFloat8Type) return std::bit_cast<double>(FromBigEndian(Raw(column)));
  return static_cast<double>(Int(column));
}

std::string_view PostgresStatement::Bytes(int column) const {
  const std::uint32_t type = PQftype(result_.get(), column);
  if (IsNull(column) || !IsWholeNumber(type)) return Raw(column);
  number_ = std::to_string(Int(column));
  return number_;
}

}  // namespace rigcal::storage
