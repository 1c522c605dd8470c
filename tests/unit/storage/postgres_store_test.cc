// A store whose rows are in PostgreSQL: what is not the same as in SQLite. Where its rows are.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "storage/database/query.h"
#include "storage/migrate.h"
#include "storage/postgres/postgres_link.h"
#include "tests/unit/storage/fixture.h"

namespace rigcal::storage {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class PostgresStoreTest : public StoreTest {
 protected:
  void SetUp() override {
    if (IsOnSqlite()) GTEST_SKIP() << "runs on PostgreSQL only: tests/postgres/with_postgres";
  }
  void OnServerOfStore(const std::string& sql) { PostgresLink(place().server).Execute(sql); }
  // Ends every other connection to the database, as a server does that is stopped.
  void CutConnections() {
    OnServerOfStore(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND pid <> "
        "pg_backend_pid()");
  }
  Error ErrorOfOpening(const std::string& server) {
    const auto store = Store::Open(StorePlace(folder_.path(), server));
    return store ? Error{} : store.error();
  }
};

TEST_F(PostgresStoreTest, ValuesComeBackAsTheyWent) {
  OnServerOfStore("CREATE TABLE rigcal.kept (number BIGINT, whole BIGINT, x DOUBLE PRECISION, text TEXT, bytes BYTEA)");
  const std::string bytes("\0\xff'\\", 4), text = "Ä 'x' \\ ?1 $1";
  const std::int64_t least = std::numeric_limits<std::int64_t>::min();
  const double third = -1.0 / 3.0;
  const std::string insert = "INSERT INTO kept VALUES (?, ?, ?, ?, ?)";
  Query(store_, insert).Bind(1, least, third, text, Blob{bytes}).Run();
  Query(store_, insert)
      .Bind(2, std::nullopt, std::nan(""), std::nullopt, std::nullopt)
      .Run();  // other types of the same statement
  Query(store_, insert).Bind(3, 7, -0.0, std::string(), Blob{}).Run();
  Query rows(store_, "SELECT whole, x, text, bytes, whole > 0 FROM kept ORDER BY number");
  ASSERT_TRUE(rows.Step());
  EXPECT_EQ(rows.Int(0), least);
  EXPECT_EQ(rows.Text(0), std::to_string(least));
  EXPECT_EQ(rows.Real(1), third);
  EXPECT_EQ(rows.Text(2), text);
  EXPECT_EQ(rows.Text(3), bytes);
  ASSERT_TRUE(rows.Step());
  for (int column = 0; column < 5; ++column) EXPECT_TRUE(rows.IsNull(column)) << column;
  EXPECT_EQ(rows.Int(0), 0);
  EXPECT_EQ(rows.Real(1), 0.0);
  EXPECT_EQ(rows.Text(3), "");
  ASSERT_TRUE(rows.Step());
  EXPECT_FALSE(std::signbit(rows.Real(1)));
  EXPECT_FALSE(rows.IsNull(3));
  EXPECT_EQ(rows.Int(4), 1);
  EXPECT_FALSE(rows.Step());
}

TEST_F(PostgresStoreTest, ATextWithAZeroByteIsRefused) {
  const Status done = store_.connection().Append("a text", [&]() -> Status {
    Query(store_, "INSERT INTO robot VALUES (?, 1)").Bind(std::string("a\0b", 3)).Run();
    return {};
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kInvalidInput) << done.error().what;
}

TEST_F(PostgresStoreTest, ConnectsAgainAfterTheServerWasAway) {
  ASSERT_TRUE(AppendRobot(store_, kRobot, {1}));
  CutConnections();
  const auto cut = HasRobot(store_, kRobot);
  EXPECT_THAT(cut ? "Check that PostgreSQL runs" : Sentence(cut.error()), HasSubstr("Check that PostgreSQL runs"));
  EXPECT_TRUE(HasRobot(store_, kRobot).value());
  EXPECT_TRUE(AppendRobot(store_, RobotId("b"), {1}));
}

TEST_F(PostgresStoreTest, AWriteThatLosesItsConnectionLeavesNothing) {
  const Status done = store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendRobot(store_, kRobot, {1}));
    CutConnections();
    EXPECT_FALSE(AppendRobot(store_, RobotId("b"), {1}));
    EXPECT_FALSE(AppendRobot(store_, RobotId("c"), {1})) << "not even by a new connection";
    return {};
  });
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, ErrorCode::kStorage);
  EXPECT_EQ(IntIn(store_, "SELECT count(*) FROM robot"), 0);
}

TEST_F(PostgresStoreTest, RefusesWhatIsNotItsOwnAndWhatIsNewer) {
  OnServerOfStore("UPDATE rigcal.schema_version SET version = 99");
  const Error newer = ErrorOfOpening(place().server);
  EXPECT_EQ(newer.code, ErrorCode::kUnsupported);
  EXPECT_THAT(newer.what, AllOf(HasSubstr("has schema version 99"), HasSubstr("postgresql://")));
  OnServerOfStore("DROP TABLE rigcal.schema_version");
  EXPECT_EQ(ErrorOfOpening(place().server).code, ErrorCode::kConflict);
}

TEST_F(PostgresStoreTest, SaysInOneSentenceWhyItCannotConnect) {
  const Error error =
      ErrorOfOpening("postgresql://ada:secret@/rigcal?host=" + folder_.path().string() + "&password=secret");
  EXPECT_EQ(error.code, ErrorCode::kStorage);
  EXPECT_THAT(Sentence(error), AllOf(HasSubstr("the store at postgresql:///rigcal: "),
                                     HasSubstr("Check that PostgreSQL runs"), Not(HasSubstr("secret"))));
}

TEST_F(PostgresStoreTest, NumbersHaveNoGaps) {
  EXPECT_FALSE(store_.Write([&]() -> Status {
    RIGCAL_TRY(AppendEdge(store_, MakeEdge(1), {1}));
    return Fail(ErrorCode::kConflict, "no", "No.");
  }));
  ASSERT_TRUE(AppendEdge(store_, MakeEdge(2), {1}));
  EXPECT_EQ(LoadEdgeWatermark(store_, kRobot).value(), 1);
}

TEST(StorePlace, IsAFolderOrADatabase) {
  EXPECT_EQ(StorePlaceOf("", "/data")->folder, "/data");
  EXPECT_EQ(StorePlaceOf("sqlite:/other", "/data")->folder, "/other");
  EXPECT_EQ(StorePlaceOf("/other", "/data")->folder, "/other");
  const StorePlace place = StorePlaceOf("postgresql://ada:pw@db:5433/rigcal?sslmode=require", "/data").value();
  EXPECT_EQ(place.folder, "/data");
  EXPECT_EQ(place.server, "postgresql://ada:pw@db:5433/rigcal?sslmode=require");
  EXPECT_EQ(NameOf(place), "postgresql://db:5433/rigcal");
  EXPECT_EQ(NameOf(StorePlaceOf("postgres://db/rigcal", "/data").value()), "postgres://db/rigcal");
  EXPECT_EQ(NameOf(StorePlace("/data")), "/data");
  EXPECT_EQ(NameOf({"/data", "postgresql://ada:sec?ret@db/rigcal?password=a@b"}), "postgresql://db/rigcal");
  for (const char* wrong : {"mysql://db/rigcal", "sqlite:"})
    EXPECT_EQ(StorePlaceOf(wrong, "/data").error().code, ErrorCode::kInvalidInput) << wrong;
}

}  // namespace
}  // namespace rigcal::storage
