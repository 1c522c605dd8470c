#include "storage/database/sqlite_engine.h"

#include <sqlite3.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "storage/database/refused_pages.h"
#include "storage/database/summing_files.h"

namespace rigcal::storage {
namespace {

constexpr int kApplicationId = 0x5267436c;  // "RgCl" in the file's header

// Without recursive triggers, INSERT OR REPLACE would delete behind the back of the append-only triggers.
constexpr const char* kSettings =
    "PRAGMA synchronous = FULL;"
    "PRAGMA foreign_keys = ON;"
    "PRAGMA recursive_triggers = ON;"
    "PRAGMA trusted_schema = OFF;"
    "PRAGMA cell_size_check = ON;"
    "PRAGMA temp_store = MEMORY;"
    "PRAGMA cache_size = -16384;"
    "PRAGMA wal_autocheckpoint = 8000;"  // pages; few copies of a page that is written again and again
    "PRAGMA journal_size_limit = 67108864;";

class SqliteStatement final : public EngineStatement {
 public:
  SqliteStatement(SQLite::Database& database, const std::string& sql) : statement_(database, sql) {}

  void Bind(int at, std::int64_t value) override { statement_.bind(at, value); }
  void Bind(int at, double value) override { statement_.bind(at, value); }
  void BindText(int at, const std::string& text) override { statement_.bind(at, text); }
  void BindTextNoCopy(int at, const std::string& text) override { statement_.bindNoCopy(at, text); }
  void BindBlob(int at, std::string_view bytes) override {
    statement_.bind(at, bytes.data(), static_cast<int>(bytes.size()));
  }

  [[nodiscard]] bool Step() override { return statement_.executeStep(); }
  int Run() override { return statement_.exec(); }
  void Reset() override {
    statement_.tryReset();
    statement_.clearBindings();
  }

  [[nodiscard]] bool IsNull(int column) const override { return statement_.isColumnNull(column); }
  [[nodiscard]] std::int64_t Int(int column) const override { return statement_.getColumn(column).getInt64(); }
  [[nodiscard]] double Real(int column) const override { return statement_.getColumn(column).getDouble(); }
  // The size after the bytes: of a number only then it is known.
  [[nodiscard]] std::string_view Bytes(int column) const override {
    const SQLite::Column cell = statement_.getColumn(column);
    const auto* bytes = static_cast<const char*>(cell.getBlob());
    return {bytes, static_cast<std::size_t>(cell.getBytes())};
  }

 private:
  SQLite::Statement statement_;
};

// Of this connection, as long as it lives.
class WithoutTriggers {
 public:
  explicit WithoutTriggers(sqlite3* database) : database_(database) { Enable(0); }
  ~WithoutTriggers() { Enable(1); }
  WithoutTriggers(const WithoutTriggers&) = delete;
  WithoutTriggers& operator=(const WithoutTriggers&) = delete;

 private:
  void Enable(int they_run) { sqlite3_db_config(database_, SQLITE_DBCONFIG_ENABLE_TRIGGER, they_run, nullptr); }
  sqlite3* database_;
};

void BindCell(SQLite::Statement& statement, int at, const StoredCell& cell) {
  if (const auto* whole = std::get_if<std::int64_t>(&cell)) return statement.bind(at, *whole);
  if (const auto* real = std::get_if<double>(&cell)) return statement.bind(at, *real);
  if (const auto* text = std::get_if<std::string>(&cell)) return statement.bindNoCopy(at, *text);
  if (const auto* blob = std::get_if<Blob>(&cell))
    return statement.bindNoCopy(at, blob->bytes.data(), static_cast<int>(blob->bytes.size()));
  statement.bind(at);
}

// INSERT INTO table (a, b) VALUES (?, ?)
std::string InsertOf(const std::string& table, const std::vector<std::string>& columns) {
  std::string names, places;
  for (const std::string& column : columns) {
    names += (names.empty() ? "" : ", ") + column;
    places += places.empty() ? "?" : ", ?";
  }
  return "INSERT INTO " + table + " (" + names + ") VALUES (" + places + ")";
}

}  // namespace

Error ErrorOf(const SQLite::Exception& failure, const std::string& subject) {
  const std::string what = subject + ": " + failure.what();
  switch (failure.getErrorCode() & 0xff) {
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      if (const auto refused = TakeRefused()) return ErrorOf(*refused, subject);
      return {ErrorCode::kStorage, what,
              "The database file is damaged: `rigcal fsck` names what is; restore it from a backup, or start with an "
              "empty folder."};
    case SQLITE_FULL:
      return {ErrorCode::kStorage, what, "Free some space on the disk."};
    case SQLITE_IOERR:
      return {ErrorCode::kStorage, what, "Check that the disk has free space and is healthy."};
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {ErrorCode::kStorage, what, "Check that the folder exists and that this user may write to it."};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorCode::kBusy, what, "Another process holds the database: wait, or stop it."};
    case SQLITE_TOOBIG:
      return {ErrorCode::kInvalidInput, what, "Send less at once: one value may take up to 1 GB."};
    case SQLITE_CONSTRAINT:
      return {ErrorCode::kConflict, what, "It contradicts what is stored: check the ids that it refers to."};
    default:
      return {ErrorCode::kStorage, what, "Check the disk, and the log of rigcald."};
  }
}

bool CannotChange(const std::filesystem::path& file) {
  struct statvfs disk = {};
  const bool is_read_only = statvfs(file.c_str(), &disk) == 0 && (disk.f_flag & ST_RDONLY) != 0;
  return is_read_only && access((file.string() + "-wal").c_str(), F_OK) != 0;
}

std::string UnchangingName(const std::filesystem::path& file) {
  std::string name = "file:";
  for (const char c : file.string()) name += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
  return name + "?immutable=1";
}

SqliteEngine::SqliteEngine(const std::filesystem::path& file)
    : database_(CannotChange(file) ? SQLite::Database(UnchangingName(file), SQLite::OPEN_READONLY | SQLite::OPEN_URI,
                                                      kPatience_ms, SummingFiles())
                                   : SQLite::Database(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE,
                                                      kPatience_ms, SummingFiles())) {
  database_.exec(kSettings);
}

std::unique_ptr<EngineStatement> SqliteEngine::Prepare(const std::string& sql) {
  return std::make_unique<SqliteStatement>(database_, sql);
}

void SqliteEngine::BeginWrite() { database_.exec("BEGIN IMMEDIATE"); }

// BEGIN alone takes no snapshot: the first read does.
void SqliteEngine::BeginRead() { database_.exec("BEGIN; SELECT 1 FROM sqlite_schema LIMIT 1"); }

void SqliteEngine::Commit() { database_.exec("COMMIT"); }

void SqliteEngine::Rollback() noexcept {
  // SQLite has already rolled back after some failures (disk full, I/O).
  if (sqlite3_get_autocommit(database_.getHandle()) == 0) database_.tryExec("ROLLBACK");
}

void SqliteEngine::SetPatience(int milliseconds) { database_.setBusyTimeout(milliseconds); }

std::optional<Error> SqliteEngine::ErrorOf(const std::exception& failure, const std::string& subject) const {
  const auto* ours = dynamic_cast<const SQLite::Exception*>(&failure);
  return ours == nullptr ? std::nullopt : std::optional(storage::ErrorOf(*ours, subject));
}

int SqliteEngine::Pragma(const char* name) { return database_.execAndGet(std::string("PRAGMA ") + name).getInt(); }

SchemaState SqliteEngine::LoadSchemaState() {
  const bool is_empty = database_.execAndGet("SELECT count(*) FROM sqlite_schema").getInt() == 0;
  return {Pragma("user_version"), Pragma("application_id") == kApplicationId, is_empty};
}

void SqliteEngine::PrepareDatabase() { database_.execAndGet("PRAGMA journal_mode = WAL"); }

void SqliteEngine::RunSchema(std::string_view sql) { database_.exec(std::string(sql)); }

void SqliteEngine::NoteSchemaVersion(int version) {
  database_.exec("PRAGMA application_id = " + std::to_string(kApplicationId) +
                 "; PRAGMA user_version = " + std::to_string(version));
}

void SqliteEngine::CopyIn(const std::string& table, const std::vector<std::string>& columns,
                          const std::vector<StoredRow>& rows) {
  const WithoutTriggers quiet(database_.getHandle());
  SQLite::Statement insert(database_, InsertOf(table, columns));
  for (const StoredRow& row : rows) {
    int at = 0;
    for (const StoredCell& cell : row) BindCell(insert, ++at, cell);
    insert.exec();
    insert.reset();
  }
}

void SqliteEngine::Empty(const std::vector<std::string>& tables) {
  const WithoutTriggers quiet(database_.getHandle());
  for (auto table = tables.rbegin(); table != tables.rend(); ++table) database_.exec("DELETE FROM " + *table);
}

}  // namespace rigcal::storage
