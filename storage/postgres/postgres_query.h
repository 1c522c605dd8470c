// A query of storage/ as PostgreSQL takes it. For storage/*.cc only.
#pragma once

#include <string>

namespace rigcal::storage {

struct PostgresQuery {
  std::string sql;
  int parameters = 0;
};

// `sql` is in what both engines understand; what differs in writing only is: parameters (? and ?1 for $1), and CROSS
// JOIN, by which SQLite is told the order of tables.
[[nodiscard]] PostgresQuery PostgresQueryOf(const std::string& sql);

}  // namespace rigcal::storage
