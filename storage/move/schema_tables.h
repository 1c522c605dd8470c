// The tables of storage/schema as the schema itself has them: what is told of them here nobody lists by hand.
#pragma once

#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::storage {

enum class ColumnKind { kWhole, kReal, kText, kBytes };
struct SchemaColumn {
  std::string name;
  ColumnKind kind = ColumnKind::kWhole;
};
struct SchemaTable {
  std::string name;
  std::vector<SchemaColumn> columns;   // with `rowid`, where only that tells in which order rows came
  std::vector<std::size_t> key;        // columns by which a row is known, and that both engines order alike
  std::vector<std::string> refers_to;  // tables
  [[nodiscard]] std::vector<std::string> ColumnNames() const;
};

// Every table whose rows are the store's wherever it is, each after those that it refers to: all but `lease_*`, which
// tell who is at it now, and in which folder. kInternal: tables refer to each other in a circle, or a column has a type
// that is not known here.
[[nodiscard]] Result<std::vector<SchemaTable>> LoadSchemaTables();

}  // namespace rigcal::storage
