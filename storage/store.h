// The database and the blob folder of one rigcald. One Store is one connection: give each thread its own (readers go on
// while one writes). All SQL lives in storage/.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>

#include "server/base/result.h"
#include "storage/store_place.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): the name is the library's
class Database;
}

namespace rigcal::storage {

class Blobs;
class Connection;

inline constexpr std::int64_t kAllRows = std::numeric_limits<std::int64_t>::max();  // the limit of a list in one piece

class Store {
 public:
  // Opens or creates the folder's rigcal.db, or the tables in the PostgreSQL database that the place names, and the
  // folder's subfolders; migrates forward; refuses a store of a newer version by name (kUnsupported) and leaves it as
  // it is; likewise one whose log has lost commits (kStorage, database/log_damage.h). On a full disk it may spend a
  // part of the reserve (room.h). SQLite: WAL, synchronous FULL, foreign keys, a busy timeout. A bucket that is not the
  // store's is refused; of a store that has one and is opened without, the blobs cannot be used (s3/store_bucket.h).
  [[nodiscard]] static Result<Store> Open(const StorePlace& place);
  ~Store();
  // A store that was moved from may only be assigned to or destroyed.
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;

  // As Open() was given them.
  [[nodiscard]] const StorePlace& place() const;
  [[nodiscard]] const std::filesystem::path& folder() const { return place().folder; }
  [[nodiscard]] const Blobs& blobs() const;                  // any thread
  [[nodiscard]] std::filesystem::path BlobFolder() const;    // folder/blobs
  [[nodiscard]] std::filesystem::path IntakeFolder() const;  // folder/intake: files not yet receipted
  [[nodiscard]] std::filesystem::path ReportFolder() const;  // folder/reports

  // Runs `body` in one immediate transaction: committed and durable when it returns good, rolled back on any error.
  // Does not nest. What the engine throws becomes an error, kStorage for those of disk and file, kBusy if another
  // process held the database for 10 s; a failure of the engine inside `body` fails the whole Write even if `body`
  // returns good. Every Append... of storage/*.h may be called inside a Write, or alone: then it is a transaction of
  // its own.
  [[nodiscard]] Status Write(const std::function<Status()>& body);
  // The same, but kBusy where another has the database for 100 ms: of what whoever asks need not wait for.
  [[nodiscard]] Status WriteSoon(const std::function<Status()>& body);
  // Runs `body` in one read snapshot; inside another Read or a Write it sees that one's.
  [[nodiscard]] Status Read(const std::function<Status()>& body);

  [[nodiscard]] Connection& connection();      // for storage/*.cc only
  [[nodiscard]] SQLite::Database& database();  // likewise; throws std::bad_cast where it is not SQLite
  // Number of the newest migration that the database has.
  [[nodiscard]] int SchemaVersion() const;

 private:
  struct Impl;
  explicit Store(std::unique_ptr<Impl> impl);
  [[nodiscard]] static Result<Store> OpenOnce(const StorePlace& place);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rigcal::storage
