// The rows of a store in another one. For storage/*.cc only.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "server/base/ids.h"
#include "storage/database/connection.h"
#include "storage/move/schema_tables.h"

namespace rigcal::storage {

using RowProgress = std::function<void(std::int64_t done, std::int64_t total)>;

// Of what there is to copy: another one tells that rows came or went. That a row was replaced it may not tell.
[[nodiscard]] Result<Digest> FingerprintOf(Connection& from, const std::vector<SchemaTable>& tables);

// What comes after the greatest key that `to` has, of each table: so it goes on where it was broken off. Some megabytes
// a transaction.
[[nodiscard]] Status CopyRows(Connection& from, Connection& to, const std::vector<SchemaTable>& tables,
                              const RowProgress& progress);

// Each row against its copy, cell by cell; the number of rows. kConflict names the first one that differs.
[[nodiscard]] Result<std::int64_t> CompareRows(Connection& from, Connection& to, const std::vector<SchemaTable>& tables,
                                               const RowProgress& progress);

}  // namespace rigcal::storage
