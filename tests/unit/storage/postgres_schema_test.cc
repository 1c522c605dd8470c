// What PostgreSQL is told, by what the schema and the queries say to SQLite.
#include "storage/postgres/postgres_schema.h"

#include <gmock/gmock.h>

#include "storage/postgres/sql_tokens.h"

namespace rigcal::storage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> NewSchemaOf(const std::string& sql) { return PostgresSchemaOf(sql, true); }

TEST(SqlTokens, KnowTextsCommentsAndParameters) {
  std::vector<std::string> texts;
  for (const SqlToken& token : SqlTokensOf("a.b <= ?12 -- it's; CASE\n|| 'it''s -- ?' ?")) texts.push_back(token.text);
  EXPECT_THAT(texts, ElementsAre("a", ".", "b", "<", "=", "?12", "|", "|", "'it''s -- ?'", "?"));
  EXPECT_EQ(SqlTextOf(SqlTokensOf(" a.b  <= 'x'\n--c\n;")), "a.b <= 'x' ;");
  EXPECT_EQ(SqlTextOf(SqlTokensOf("'open")), "'open");
}

TEST(SqlTokens, AStatementOfATriggerIsAPartOfIt) {
  const auto statements =
      SqlStatementsOf("SELECT 1; CREATE TRIGGER t BEGIN SELECT CASE a WHEN 1 THEN 2 END; SELECT 3; END; ; SELECT 4");
  ASSERT_EQ(statements.size(), 3u);
  EXPECT_EQ(SqlTextOf(statements[1]), "CREATE TRIGGER t BEGIN SELECT CASE a WHEN 1 THEN 2 END; SELECT 3; END");
}

TEST(PostgresQuery, NumbersItsParametersAsSqliteDoes) {
  const PostgresQuery query = PostgresQueryOf("SELECT '?' WHERE a = ? AND b = ?4 AND c = ?1 AND d < ?");
  EXPECT_EQ(query.sql, "SELECT '?' WHERE a = $1 AND b = $4 AND c = $1 AND d < $5");
  EXPECT_EQ(query.parameters, 5);
  EXPECT_EQ(PostgresQueryOf("SELECT 1").parameters, 0);
}

TEST(PostgresQuery, JoinsInItsOwnOrder) {
  EXPECT_EQ(SqlTextOf(SqlTokensOf(PostgresQueryOf("SELECT * FROM a CROSS JOIN b ON b.x = a.x").sql)),
            "SELECT * FROM a JOIN b ON b.x = a.x");
}

TEST(PostgresSchema, ATableHasItsTypesAndNumbersItself) {
  const auto statements =
      NewSchemaOf("CREATE TABLE t (number INTEGER PRIMARY KEY, text TEXT NOT NULL, x_m REAL, b BLOB) STRICT;");
  ASSERT_EQ(statements.size(), 3u);
  EXPECT_EQ(
      statements[0],
      "CREATE TABLE t (number BIGINT PRIMARY KEY, text TEXT COLLATE \"C\" NOT NULL, x_m DOUBLE PRECISION, b BYTEA)");
  EXPECT_THAT(
      statements[1],
      HasSubstr("IF new.number IS NULL THEN new.number := coalesce((SELECT max(number) FROM t), 0) + 1; END IF;"));
  EXPECT_EQ(statements[2], "CREATE TRIGGER t_number BEFORE INSERT ON t FOR EACH ROW EXECUTE FUNCTION t_number()");
}

TEST(PostgresSchema, KnowsTheOrderOfRowsWhereSqliteDoes) {
  const auto statements = NewSchemaOf("CREATE TABLE t (id TEXT PRIMARY KEY) STRICT");
  ASSERT_EQ(statements.size(), 4u);
  EXPECT_EQ(statements[1], "ALTER TABLE t ADD COLUMN rowid BIGINT UNIQUE");
  EXPECT_THAT(statements[2], HasSubstr("new.rowid := coalesce((SELECT max(rowid) FROM t), 0) + 1;"));
  EXPECT_THAT(NewSchemaOf("CREATE TABLE t (id TEXT PRIMARY KEY) STRICT, WITHOUT ROWID"),
              ElementsAre("CREATE TABLE t (id TEXT COLLATE \"C\" PRIMARY KEY)"));
}

TEST(PostgresSchema, ANumberOfAnotherTableIsGiven) {
  EXPECT_THAT(NewSchemaOf("CREATE TABLE t (number INTEGER PRIMARY KEY REFERENCES audit) STRICT, WITHOUT ROWID"),
              ElementsAre("CREATE TABLE t (number BIGINT PRIMARY KEY REFERENCES audit)"));
}

TEST(PostgresSchema, AnAppendOnlyTableIsNotEmptiedEither) {
  const auto statements =
      NewSchemaOf("CREATE TRIGGER t_no_delete BEFORE DELETE ON t BEGIN SELECT RAISE(ABORT, 'append-only'); END;");
  ASSERT_EQ(statements.size(), 3u);
  EXPECT_THAT(statements[0],
              HasSubstr("RAISE EXCEPTION USING MESSAGE = 'append-only', ERRCODE = 'integrity_constraint_violation';"));
  EXPECT_EQ(statements[1], "CREATE TRIGGER t_no_delete BEFORE DELETE ON t FOR EACH ROW EXECUTE FUNCTION t_no_delete()");
  EXPECT_EQ(statements[2],
            "CREATE TRIGGER t_no_truncate BEFORE TRUNCATE ON t FOR EACH STATEMENT EXECUTE FUNCTION t_no_delete()");
}

TEST(PostgresSchema, WhatATriggerDoesIsAFunction) {
  const auto statements = NewSchemaOf(
      "CREATE TRIGGER w AFTER INSERT ON t WHEN EXISTS (SELECT 1 FROM u WHERE id = new.id)\n"
      "BEGIN INSERT OR IGNORE INTO v VALUES (new.id); INSERT INTO c VALUES (new.id, 1) ON CONFLICT (id) DO UPDATE SET "
      "n = n + 1; END;");
  ASSERT_EQ(statements.size(), 2u);
  EXPECT_THAT(
      statements[0],
      HasSubstr(
          "IF EXISTS (SELECT 1 FROM u WHERE id = new.id) THEN INSERT INTO v VALUES (new.id) ON CONFLICT DO NOTHING; "
          "INSERT INTO c VALUES (new.id, 1) ON CONFLICT (id) DO UPDATE SET n = c.n + 1; END IF;"));
  EXPECT_EQ(statements[1], "CREATE TRIGGER w AFTER INSERT ON t FOR EACH ROW EXECUTE FUNCTION w()");
  EXPECT_THAT(NewSchemaOf("DROP TRIGGER w"), ElementsAre("DROP FUNCTION w() CASCADE"));
}

TEST(PostgresSchema, ANewStoreHasNoRowsToMove) {
  const std::string from_another = "INSERT INTO a SELECT x FROM b",
                    of_nothing = "INSERT INTO a SELECT 1, (SELECT count(*) FROM b)", changing = "UPDATE a SET x = 1";
  EXPECT_THAT(NewSchemaOf(from_another + ";" + changing), IsEmpty());
  EXPECT_THAT(NewSchemaOf(of_nothing), ElementsAre(of_nothing));
  EXPECT_THAT(PostgresSchemaOf(from_another + ";" + changing, false), ElementsAre(from_another, changing));
}

}  // namespace
}  // namespace rigcal::storage
