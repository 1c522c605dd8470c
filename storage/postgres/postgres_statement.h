// A prepared statement of PostgreSQL. For storage/*.cc only.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "storage/database/engine.h"
#include "storage/postgres/postgres_link.h"
#include "storage/postgres/sql_tokens.h"

namespace rigcal::storage {

// Its rows come all at once: other statements may run between two of them.
class PostgresStatement final : public EngineStatement {
 public:
  // Both must live as long.
  PostgresStatement(PostgresLink& link, PostgresQuery query) : link_(link), query_(std::move(query)) { Clear(); }

  void Bind(int at, std::int64_t value) override;
  void Bind(int at, double value) override;
  void BindText(int at, const std::string& text) override;
  void BindTextNoCopy(int at, const std::string& text) override { BindText(at, text); }
  void BindBlob(int at, std::string_view bytes) override;

  [[nodiscard]] bool Step() override;
  int Run() override;
  void Reset() override { Clear(); }

  [[nodiscard]] bool IsNull(int column) const override;
  [[nodiscard]] std::int64_t Int(int column) const override;
  [[nodiscard]] double Real(int column) const override;
  [[nodiscard]] std::string_view Bytes(int column) const override;

 private:
  struct Prepared {
    std::string name;
    int generation = 0;  // of the connection that knows it
  };

  void Clear();
  void Execute();
  // A parameter that was NULL when the server was told of the statement has the type that the server found: with
  // another set of types it is another statement.
  [[nodiscard]] const std::string& PreparedName();
  [[nodiscard]] std::string_view Raw(int column) const;

  PostgresLink& link_;
  PostgresQuery query_;
  std::map<std::vector<std::uint32_t>, Prepared> prepared_;  // by the types of its parameters
  std::vector<PostgresValue> values_;
  PostgresResult result_;
  int row_ = -1;
  mutable std::string number_;  // that was asked for as a text
};

}  // namespace rigcal::storage
