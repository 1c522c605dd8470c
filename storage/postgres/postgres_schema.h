// A file of storage/schema, which is written as SQLite takes it, as PostgreSQL takes it. For storage/*.cc only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rigcal::storage {

// Statements, one by one. Columns have PostgreSQL's types, texts the order of their bytes. `number` that nobody gives,
// and `rowid` where SQLite has one beside the columns, is one more than the greatest, by a trigger. The body of a
// trigger becomes a function of the trigger's name. What a trigger refuses is refused with class 23 (integrity), and of
// an append-only table also TRUNCATE. `is_new`: the store is being made, so that statements which would only move rows
// of before are left out.
[[nodiscard]] std::vector<std::string> PostgresSchemaOf(std::string_view sql, bool is_new);

}  // namespace rigcal::storage
