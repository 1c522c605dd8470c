#include "storage/postgres/postgres_schema.h"

#include <algorithm>
#include <map>

#include "storage/postgres/sql_tokens.h"

namespace rigcal::storage {
namespace {

using Tokens = std::vector<SqlToken>;
using Statements = std::vector<std::string>;

const std::map<std::string, std::string> kPostgresTypes = {
    {"INTEGER", "BIGINT"}, {"REAL", "DOUBLE PRECISION"}, {"BLOB", "BYTEA"}, {"TEXT", "TEXT COLLATE \"C\""}};

Tokens Part(const Tokens& tokens, std::size_t first, std::size_t end) {
  return {tokens.begin() + static_cast<std::ptrdiff_t>(first), tokens.begin() + static_cast<std::ptrdiff_t>(end)};
}

// The first place of the word from `at` on; the end where there is none.
std::size_t FindWord(const Tokens& tokens, std::size_t at, std::string_view word) {
  const auto from = tokens.begin() + static_cast<std::ptrdiff_t>(std::min(at, tokens.size()));
  return static_cast<std::size_t>(
      std::find_if(from, tokens.end(), [&](const SqlToken& one) { return one.text == word; }) - tokens.begin());
}

std::string WithPostgresTypes(Tokens tokens) {
  for (SqlToken& token : tokens)
    if (const auto type = kPostgresTypes.find(token.text); type != kPostgresTypes.end()) token.text = type->second;
  return SqlTextOf(tokens);
}

std::string FunctionOf(const std::string& name, const std::string& body) {
  return "CREATE OR REPLACE FUNCTION " + name + "() RETURNS trigger LANGUAGE plpgsql AS $body$ BEGIN " + body +
         " IF TG_OP = 'DELETE' THEN RETURN old; END IF; RETURN new; END $body$";
}

std::string TriggerOf(const std::string& name, const std::string& when, const std::string& table,
                      const std::string& each, const std::string& function) {
  return "CREATE TRIGGER " + name + " " + when + " ON " + table + " FOR EACH " + each + " EXECUTE FUNCTION " +
         function + "()";
}

// "number INTEGER PRIMARY KEY" that refers to no other table.
bool NumbersItself(const Tokens& tokens) {
  for (std::size_t at = 0; at < tokens.size(); ++at)
    if (HasWords(tokens, at, {"number", "INTEGER", "PRIMARY", "KEY"})) return !HasWords(tokens, at + 4, {"REFERENCES"});
  return false;
}

// In which order its rows came SQLite knows by itself, where no column takes that place.
bool HasRowid(const Tokens& tokens) {
  for (std::size_t at = 0; at < tokens.size(); ++at)
    if (HasWords(tokens, at, {"INTEGER", "PRIMARY", "KEY"}) || HasWords(tokens, at, {"WITHOUT", "ROWID"})) return false;
  return true;
}

// A row's `column` is one more than the greatest before, unless it is given.
void AddNumbering(const std::string& table, const std::string& column, Statements& statements) {
  const std::string function = table + "_" + column, of_row = "new." + column;
  statements.push_back(FunctionOf(function, "IF " + of_row + " IS NULL THEN " + of_row + " := coalesce((SELECT max(" +
                                                column + ") FROM " + table + "), 0) + 1; END IF;"));
  statements.push_back(TriggerOf(function, "BEFORE INSERT", table, "ROW", function));
}

// CREATE TABLE name (...) STRICT, WITHOUT ROWID
void AddTable(Tokens tokens, Statements& statements) {
  const bool has_rowid = HasRowid(tokens);
  while (!tokens.empty() && tokens.back().text != ")") tokens.pop_back();
  statements.push_back(WithPostgresTypes(tokens));
  const std::string& table = tokens[2].text;
  if (has_rowid) statements.push_back("ALTER TABLE " + table + " ADD COLUMN rowid BIGINT UNIQUE");
  if (has_rowid) AddNumbering(table, "rowid", statements);
  if (NumbersItself(tokens)) AddNumbering(table, "number", statements);
}

// DO UPDATE SET robots = robots + 1: the second one is the table's, and PostgreSQL wants that said.
void QualifyUpdated(Tokens& tokens) {
  const std::size_t table = FindWord(tokens, 0, "INTO") + 1;
  for (std::size_t at = 0; at + 5 < tokens.size(); ++at)
    if (HasWords(tokens, at, {"DO", "UPDATE", "SET"}) && tokens[at + 3].text == tokens[at + 5].text)
      tokens[at + 5].text = tokens[table].text + "." + tokens[at + 5].text;
}

// A statement of a trigger.
std::string InFunction(Tokens tokens) {
  if (HasWords(tokens, 0, {"SELECT", "RAISE", "(", "ABORT", ","}))
    return "RAISE EXCEPTION USING MESSAGE = " + tokens[5].text + ", ERRCODE = 'integrity_constraint_violation';";
  const bool ignores = HasWords(tokens, 0, {"INSERT", "OR", "IGNORE"});
  if (ignores) tokens.erase(tokens.begin() + 1, tokens.begin() + 3);
  QualifyUpdated(tokens);
  return SqlTextOf(tokens) + (ignores ? " ON CONFLICT DO NOTHING;" : ";");
}

std::string BodyOf(const Tokens& tokens, std::size_t begin) {
  std::string body;
  // Without BEGIN and END.
  for (const Tokens& one : SqlStatementsOf(SqlTextOf(Part(tokens, begin + 1, tokens.size() - 1))))
    body += InFunction(one) + " ";
  const std::size_t when = FindWord(tokens, 0, "WHEN");
  if (when >= begin) return body;
  return "IF " + SqlTextOf(Part(tokens, when + 1, begin)) + " THEN " + body + "END IF;";
}

// CREATE TRIGGER name BEFORE INSERT ON table WHEN ... BEGIN ...; END
void AddTrigger(const Tokens& tokens, Statements& statements) {
  const std::string& name = tokens[2].text;
  const std::size_t on = FindWord(tokens, 0, "ON"), begin = FindWord(tokens, 0, "BEGIN");
  const std::string& table = tokens[on + 1].text;
  statements.push_back(FunctionOf(name, BodyOf(tokens, begin)));
  statements.push_back(TriggerOf(name, SqlTextOf(Part(tokens, 3, on)), table, "ROW", name));
  if (name == table + "_no_delete")
    statements.push_back(TriggerOf(table + "_no_truncate", "BEFORE TRUNCATE", table, "STATEMENT", name));
}

// An INSERT whose rows come from other tables, and every UPDATE and DELETE.
bool MovesRows(const Tokens& tokens) {
  int depth = 0;
  for (const SqlToken& token : tokens) {
    depth += token.text == "(" ? 1 : token.text == ")" ? -1 : 0;
    if (depth == 0 && token.text == "FROM") return true;
  }
  return tokens.front().text == "UPDATE";
}

void AddStatement(const Tokens& tokens, bool is_new, Statements& statements) {
  if (HasWords(tokens, 0, {"CREATE", "TABLE"})) return AddTable(tokens, statements);
  if (HasWords(tokens, 0, {"CREATE", "TRIGGER"})) return AddTrigger(tokens, statements);
  if (HasWords(tokens, 0, {"ALTER", "TABLE"})) return statements.push_back(WithPostgresTypes(tokens));
  if (HasWords(tokens, 0, {"DROP", "TRIGGER"}))
    return statements.push_back("DROP FUNCTION " + tokens[2].text + "() CASCADE");
  const bool is_definition = tokens.front().text == "CREATE" || tokens.front().text == "DROP";
  if (is_definition || !is_new || !MovesRows(tokens)) statements.push_back(SqlTextOf(tokens));
}

}  // namespace

std::vector<std::string> PostgresSchemaOf(std::string_view sql, bool is_new) {
  Statements statements;
  for (const Tokens& tokens : SqlStatementsOf(sql)) AddStatement(tokens, is_new, statements);
  return statements;
}

}  // namespace rigcal::storage
