#include "storage/postgres/postgres_query.h"

#include <algorithm>

#include "storage/postgres/sql_tokens.h"

namespace rigcal::storage {

PostgresQuery PostgresQueryOf(const std::string& sql) {
  std::vector<SqlToken> tokens = SqlTokensOf(sql);
  PostgresQuery query;
  for (std::size_t at = 0; at < tokens.size(); ++at) {
    std::string& text = tokens[at].text;
    if (text.front() == '?') {
      const int number = text.size() > 1 ? std::stoi(text.substr(1)) : query.parameters + 1;
      query.parameters = std::max(query.parameters, number);
      text = "$" + std::to_string(number);
    } else if (HasWords(tokens, at, {"CROSS", "JOIN"})) {
      text.clear();
    }
  }
  query.sql = SqlTextOf(tokens);
  return query;
}

}  // namespace rigcal::storage
