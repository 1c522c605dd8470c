#include "storage/postgres/sql_tokens.h"

#include <algorithm>
#include <cctype>

namespace rigcal::storage {
namespace {

bool IsWordCharacter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Where the run of characters that are alike ends.
std::size_t EndOfRun(std::string_view sql, std::size_t at, bool (*is_of_run)(char)) {
  while (at < sql.size() && is_of_run(sql[at])) ++at;
  return at;
}

// After blanks and comments.
std::size_t SkipBlanks(std::string_view sql, std::size_t at) {
  while (at < sql.size()) {
    if (sql.substr(at, 2) == "--")
      at = std::min(sql.find('\n', at), sql.size());
    else if (std::isspace(static_cast<unsigned char>(sql[at])) != 0)
      ++at;
    else
      break;
  }
  return at;
}

// A quote within a text is written twice: that looks like two texts beside each other.
std::size_t EndOfQuoted(std::string_view sql, std::size_t at) {
  const char quote = sql[at];
  for (;;) {
    const std::size_t close = sql.find(quote, at + 1);
    if (close == std::string_view::npos) return sql.size();
    if (close + 1 >= sql.size() || sql[close + 1] != quote) return close + 1;
    at = close + 1;
  }
}

std::size_t EndOfToken(std::string_view sql, std::size_t at) {
  if (sql[at] == '\'' || sql[at] == '"') return EndOfQuoted(sql, at);
  if (IsWordCharacter(sql[at]) || sql[at] == '?') return EndOfRun(sql, at + 1, IsWordCharacter);
  return at + 1;
}

}  // namespace

std::vector<SqlToken> SqlTokensOf(std::string_view sql) {
  std::vector<SqlToken> tokens;
  for (std::size_t end = 0;;) {
    const std::size_t at = SkipBlanks(sql, end);
    if (at >= sql.size()) return tokens;
    const bool is_apart = at > end;
    end = EndOfToken(sql, at);
    tokens.push_back({std::string(sql.substr(at, end - at)), is_apart});
  }
}

std::string SqlTextOf(const std::vector<SqlToken>& tokens) {
  std::string text;
  for (const SqlToken& token : tokens) text += (token.is_apart && !text.empty() ? " " : "") + token.text;
  return text;
}

std::vector<std::vector<SqlToken>> SqlStatementsOf(std::string_view sql) {
  std::vector<std::vector<SqlToken>> statements(1);
  int open = 0;  // BEGIN of a trigger, and CASE: both end in END
  for (SqlToken& token : SqlTokensOf(sql)) {
    if (token.text == "BEGIN" || token.text == "CASE") ++open;
    if (token.text == "END") --open;
    if (token.text != ";" || open > 0)
      statements.back().push_back(std::move(token));
    else if (!statements.back().empty())
      statements.emplace_back();
  }
  if (statements.back().empty()) statements.pop_back();
  return statements;
}

bool HasWords(const std::vector<SqlToken>& tokens, std::size_t at, std::initializer_list<std::string_view> words) {
  if (at + words.size() > tokens.size()) return false;
  return std::equal(words.begin(), words.end(), tokens.begin() + static_cast<std::ptrdiff_t>(at),
                    [](std::string_view word, const SqlToken& token) { return word == token.text; });
}

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
