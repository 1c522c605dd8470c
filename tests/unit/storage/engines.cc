#include "tests/unit/storage/engines.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>
#include <stdexcept>

#include "storage/database/query.h"
#include "storage/database/summing_files.h"
#include "storage/postgres/postgres_link.h"

namespace rigcal::storage {
namespace {

// "postgresql://USER@/NAME?host=FOLDER": what comes before its NAME, what comes after. Nothing: the tests run on
// SQLite.
struct TestServer {
  std::string before, after;

  [[nodiscard]] std::string Database(const std::string& name) const { return before + name + after; }
};

const std::optional<TestServer>& TestServerOfRun() {
  static const std::optional<TestServer> server = []() -> std::optional<TestServer> {
    const char* before = std::getenv("RIGCAL_TEST_POSTGRES");
    const char* after = std::getenv("RIGCAL_TEST_POSTGRES_OPTIONS");
    if (before == nullptr || after == nullptr) return std::nullopt;
    return TestServer{before, after};
  }();
  return server;
}

void OnServer(const std::string& sql) { PostgresLink(TestServerOfRun()->Database("postgres")).Execute(sql); }

std::string NewDatabaseName() {
  static int count = 0;
  return "store_" + std::to_string(getpid()) + "_" + std::to_string(++count);
}

// A database with an empty store that others are copied from: made once, as that takes a second.
std::string TemplateDatabase(const std::filesystem::path& folder) {
  const std::string name = "empty_store_" + std::to_string(getpid());
  OnServer("CREATE DATABASE " + name);
  const auto made = Store::Open(StorePlace(folder, TestServerOfRun()->Database(name)));
  if (!made) throw std::runtime_error(made.error().what);
  // A copy has a folder of its own.
  PostgresLink(TestServerOfRun()->Database(name)).Execute("DELETE FROM rigcal.lease_folder");
  std::filesystem::remove(folder / "store-id");
  return name;
}

std::vector<std::string> AppendOnlyTriggers(SQLite::Database& file) {
  std::vector<std::string> triggers;
  SQLite::Statement query(
      file,
      "SELECT name FROM sqlite_schema WHERE type = 'trigger' AND (name LIKE '%_no_update' OR name LIKE '%_no_delete')");
  while (query.executeStep()) triggers.push_back(query.getColumn(0).getString());
  return triggers;
}

}  // namespace

bool IsOnSqlite() { return !TestServerOfRun().has_value(); }

TempDatabase::TempDatabase(const std::filesystem::path& folder) {
  if (IsOnSqlite()) return;
  static const std::string empty_store = TemplateDatabase(folder);
  name_ = NewDatabaseName();
  OnServer("CREATE DATABASE " + name_ + " TEMPLATE " + empty_store);
}

TempDatabase::TempDatabase() {
  if (IsOnSqlite()) return;
  name_ = NewDatabaseName();
  OnServer("CREATE DATABASE " + name_);
}

TempDatabase::~TempDatabase() {
  if (!name_.empty()) OnServer("DROP DATABASE " + name_ + " WITH (FORCE)");
}

StorePlace TempDatabase::In(const std::filesystem::path& folder) const {
  return name_.empty() ? StorePlace(folder) : StorePlace(folder, TestServerOfRun()->Database(name_));
}

std::vector<std::string> ColumnIn(Store& store, const std::string& sql) {
  Query query(store, sql);
  std::vector<std::string> values;
  while (query.Step()) values.push_back(query.Text(0));
  return values;
}

std::string TextIn(Store& store, const std::string& sql) {
  Query query(store, sql);
  return query.Step() ? query.Text(0) : "";
}

std::int64_t IntIn(Store& store, const std::string& sql) {
  Query query(store, sql);
  return query.Step() ? query.Int(0) : 0;
}

double RealIn(Store& store, const std::string& sql) {
  Query query(store, sql);
  return query.Step() ? query.Real(0) : 0.0;
}

void TamperWith(const StorePlace& place, const std::string& sql) {
  if (!place.server.empty()) {
    PostgresLink(place.server).Execute("SET session_replication_role = replica; " + sql);
    return;
  }
  // With good sums: what is tested is what is found in the rows themselves.
  SQLite::Database file((place.folder / "rigcal.db").string(), SQLite::OPEN_READWRITE, 0, SummingFiles());
  for (const std::string& trigger : AppendOnlyTriggers(file)) file.exec("DROP TRIGGER " + trigger);
  file.exec("PRAGMA foreign_keys = OFF; " + sql);
}

std::string BytesInSql(const std::string& digits) {
  return IsOnSqlite() ? "x'" + digits + "'" : "'\\x" + digits + "'::bytea";
}

}  // namespace rigcal::storage
