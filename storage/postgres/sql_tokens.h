// SQL, taken apart as far as its translation needs it. For storage/*.cc only.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rigcal::storage {

struct SqlToken {
  std::string text;       // a word, a whole text in quotes, a parameter ("?", "?12"), or one other character
  bool is_apart = false;  // from the one before, by blanks or a comment
};

// Without comments and blanks. A text that is not closed goes to the end.
[[nodiscard]] std::vector<SqlToken> SqlTokensOf(std::string_view sql);
// The other way: one blank where something was apart.
[[nodiscard]] std::string SqlTextOf(const std::vector<SqlToken>& tokens);
// As statements, each without its semicolon; one of a trigger is a part of its trigger.
[[nodiscard]] std::vector<std::vector<SqlToken>> SqlStatementsOf(std::string_view sql);
// Whether the tokens from `at` on are these words.
[[nodiscard]] bool HasWords(const std::vector<SqlToken>& tokens, std::size_t at,
                            std::initializer_list<std::string_view> words);

// A query of storage/ as PostgreSQL takes it. For storage/*.cc only.
struct PostgresQuery {
  std::string sql;
  int parameters = 0;
};

// `sql` is in what both engines understand; what differs in writing only is: parameters (? and ?1 for $1), and CROSS
// JOIN, by which SQLite is told the order of tables.
[[nodiscard]] PostgresQuery PostgresQueryOf(const std::string& sql);

}  // namespace rigcal::storage
