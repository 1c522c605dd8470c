// A store that another one is being copied into, until all of it is there: nobody else opens it meanwhile, and the same
// copy broken off goes on in it. For storage/*.cc only.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/base/files/file_descriptor.h"
#include "server/base/ids.h"
#include "storage/database/connection.h"
#include "storage/move/schema_tables.h"
#include "storage/store_place.h"

namespace rigcal::storage {

// There is a store at `place` that is not this copy.
[[nodiscard]] Error TakenError(const StorePlace& place);

// What tells it: the file `unfinished-copy` in its folder, and of the database the version (kUnfinishedVersion) and the
// table unfinished_copy, gone with the last transaction.
class UnfinishedCopy {
 public:
  // Makes one of `source` at `place`, or opens the one that is there; its folder is locked as long.
  // kConflict: another process uses the folder; something else is there, be it another store or a copy of another
  // source; database and folder are not of one another. Then nothing is changed.
  [[nodiscard]] static Result<UnfinishedCopy> Open(const StorePlace& place, const std::string& source,
                                                   const std::vector<SchemaTable>& tables);

  [[nodiscard]] Connection& connection() { return *connection_; }
  // There is a store at its place: Finish() had been called before this process, and only its folder still says
  // otherwise, or it is a store of its own. The rows tell; where it is the copy, call Finish().
  [[nodiscard]] bool is_finished() const { return is_finished_; }
  // What BeginAnew was told by the process before; nothing: no row was copied yet.
  [[nodiscard]] const std::optional<Digest>& fingerprint() const { return fingerprint_; }

  // No row is in it; that of the source is kept.
  [[nodiscard]] Status BeginAnew(const Digest& fingerprint);
  // From now on it is a store, on disk.
  [[nodiscard]] Status Finish();

 private:
  UnfinishedCopy(StorePlace place, std::string source, std::vector<std::string> tables)
      : place_(std::move(place)), source_(std::move(source)), tables_(std::move(tables)) {}

  [[nodiscard]] Status OpenDatabase();
  [[nodiscard]] Status LookAtDatabase(bool folder_is_ours);
  [[nodiscard]] Status LookAtCopy(bool folder_is_ours);
  [[nodiscard]] Status MakeFolder();
  [[nodiscard]] Status MakeTables();
  [[nodiscard]] Status Tie();

  StorePlace place_;
  std::string source_;
  std::vector<std::string> tables_;  // each after those that it refers to
  FileDescriptor lock_{-1};          // of its folder
  std::unique_ptr<Connection> connection_;
  std::optional<Digest> fingerprint_;
  bool is_there_ = false, is_finished_ = false;
};

}  // namespace rigcal::storage
