#include "storage/move/move_store.h"

#include <optional>

#include "storage/files/folders.h"
#include "storage/move/copy_files.h"
#include "storage/move/copy_rows.h"
#include "storage/move/source.h"
#include "storage/move/unfinished_copy.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

using Tables = std::vector<SchemaTable>;

std::string WholeNameOf(const fs::path& folder) {
  std::error_code ignored;
  return fs::weakly_canonical(fs::absolute(folder, ignored), ignored).string() + "/";
}

// Neither in the other: what is a file of the one would be one of the other.
Status RefuseSharedFolder(const MoveOptions& options) {
  const std::string from = WholeNameOf(options.from.folder), to = WholeNameOf(options.to.folder);
  if (from.rfind(to, 0) != 0 && to.rfind(from, 0) != 0) return {};
  return Fail(ErrorCode::kInvalidInput,
              "the copy's folder " + options.to.folder.string() + " and the store's, " + options.from.folder.string() +
                  ", are one, or one lies in the other",
              "Give a new folder for the copy, best on the same disk: its files are links there.");
}

// Each stage of the work on rows.
struct RowWork {
  const MoveOptions& options;
  Connection& from;
  UnfinishedCopy& copy;
  const Tables& tables;

  [[nodiscard]] RowProgress ProgressOf(MoveStage stage) const {
    return [this, stage](std::int64_t done, std::int64_t total) { options.progress(stage, done, total); };
  }
  [[nodiscard]] Result<std::int64_t> CopyAndCompare() const {
    RIGCAL_TRY(CopyRows(from, copy.connection(), tables, ProgressOf(MoveStage::kCopyingRows)));
    return CompareRows(from, copy.connection(), tables, ProgressOf(MoveStage::kComparingRows));
  }
};

// Where the store changed since the copy was begun, what was copied is of no use.
Result<std::int64_t> MoveRows(const RowWork& work, bool& went_on) {
  RIGCAL_ASSIGN(const Digest fingerprint, FingerprintOf(work.from, work.tables));
  went_on = work.copy.fingerprint() == fingerprint;
  if (went_on) {
    auto rows = work.CopyAndCompare();
    if (rows || rows.error().code != ErrorCode::kConflict) return rows;
    went_on = false;
  }
  RIGCAL_TRY(work.copy.BeginAnew(fingerprint));
  return work.CopyAndCompare();
}

Result<Digest> FingerprintOfSource(Store& source, const Tables& tables) {
  std::optional<Digest> fingerprint;
  RIGCAL_TRY(HoldStill(source, [&]() -> Status {
    RIGCAL_ASSIGN(fingerprint, FingerprintOf(source.connection(), tables));
    return {};
  }));
  return *fingerprint;
}

// A store that somebody else made in the folder meanwhile is not the copy.
Status CheckIsCopy(Store& source, UnfinishedCopy& copy, const Tables& tables, const StorePlace& to) {
  RIGCAL_ASSIGN(const Digest here, FingerprintOfSource(source, tables));
  RIGCAL_ASSIGN(const Digest there, FingerprintOf(copy.connection(), tables));
  return here == there ? Status() : Fail(TakenError(to));
}

// What came to the store after the snapshot that was copied would be lost.
Status RefuseChanged(Store& source, const UnfinishedCopy& copy, const Tables& tables) {
  RIGCAL_TRY(RefuseAtWork(source));
  RIGCAL_ASSIGN(const Digest now, FingerprintOfSource(source, tables));
  if (copy.fingerprint() == now) return {};
  return Fail(ErrorCode::kConflict, "the store at " + NameOf(source.place()) + " changed while it was copied",
              "Stop whatever writes to it, then run the same `rigcal migrate-store` again.");
}

}  // namespace

Result<Moved> MoveStore(const MoveOptions& options) {
  RIGCAL_TRY(RefuseSharedFolder(options));
  RIGCAL_ASSIGN(const Tables tables, LoadSchemaTables());
  RIGCAL_ASSIGN(Source source, OpenSource(options.from));
  RIGCAL_ASSIGN(UnfinishedCopy copy, UnfinishedCopy::Open(options.to, SourceNameOf(options.from), tables));
  Moved moved;
  moved.tables = static_cast<std::int64_t>(tables.size());
  moved.was_there = copy.is_finished();
  if (moved.was_there) {
    RIGCAL_TRY(CheckIsCopy(source.store, copy, tables, options.to));
    RIGCAL_TRY(copy.Finish());
    return moved;
  }
  const bool is_still = options.from.server.empty();  // and not a snapshot, that a database would not keep so long
  const auto finish = [&]() -> Status {
    RIGCAL_TRY(
        CopyFiles(copy.connection(), source.store.BlobFolder(), BlobFolderOf(options.to.folder), options, moved));
    if (!is_still) RIGCAL_TRY(RefuseChanged(source.store, copy, tables));
    return copy.Finish();
  };
  RIGCAL_TRY(HoldStill(source.store, [&]() -> Status {
    RIGCAL_ASSIGN(moved.rows, MoveRows({options, source.store.connection(), copy, tables}, moved.went_on));
    return is_still ? finish() : Status();
  }));
  if (!is_still) RIGCAL_TRY(finish());
  return moved;
}

}  // namespace rigcal::storage
