// The log (WAL) of a database that nobody has opened yet: whether SQLite would read all of it.
#include "server/base/digests/sha256.h"
#include "server/base/files/durable_file.h"
#include "storage/database/log_damage.h"
#include "storage/files/folder_lock.h"
#include "storage/upkeep/fsck.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLogBytesMax = 1 << 30;  // the server's own stays below 64 MiB
constexpr std::size_t kDigits = 16;

std::string AsideBegin(const fs::path& log) { return log.filename().string() + ".damaged-"; }

std::vector<std::string> LogsAside(const fs::path& data) {
  std::vector<std::string> names;
  const std::string begin = AsideBegin(LogFile(data));
  std::error_code failed;
  for (fs::directory_iterator at(data, failed), end; !failed && at != end; at.increment(failed))
    if (const std::string name = at->path().filename().string(); name.rfind(begin, 0) == 0) names.push_back(name);
  return names;
}

// Whole, by a name with its digest. The name.
Result<std::string> KeepLog(const fs::path& log) {
  RIGCAL_ASSIGN(const std::string bytes, ReadFile(log, kLogBytesMax));
  const std::string name = AsideBegin(log) + Sha256Of(bytes).str().substr(0, kDigits);
  RIGCAL_TRY(WriteDurably(log.parent_path() / name, bytes));
  return name;
}

// SQLite reads then what it would have read before, or nothing where the database is newer than that.
Result<Finding> SetAside(const LogDamage& damage, const fs::path& data, Finding finding) {
  RIGCAL_ASSIGN(const std::string name, KeepLog(LogFile(data)));
  const bool is_stored = damage.kind == LogDamage::Kind::kStored;
  std::error_code failed;
  fs::resize_file(LogFile(data), is_stored ? 0 : static_cast<std::uintmax_t>(damage.read_bytes), failed);
  if (failed)
    return Fail(ErrorCode::kStorage, LogFile(data).string() + " cannot be cut: " + failed.message(),
                "Mend the permissions of the folder.");
  finding.is_mended = is_stored;
  finding.cure = is_stored ? "It was set aside as " + name + ": nothing is lost."
                           : "It was kept as " + name +
                                 ", and what lies before that byte was taken: push again what came since, or restore a "
                                 "newer backup.";
  return finding;
}

// The index of a log that is gone is of no use: with it, the server would go on to refuse the store.
Finding GoOnWithout(const fs::path& data, Finding finding) {
  std::error_code failed;
  fs::remove(LogIndexFile(data), failed);
  finding.cure = "The store goes on without it: push again what came since, or restore a newer backup.";
  return finding;
}

// Whoever repairs has the folder locked for itself.
bool IsInUse(const FsckOptions& options) { return !options.repair && IsFolderInUse(options.place.folder); }

void TellOfLogsAside(const fs::path& data, FsckDone& done) {
  for (const std::string& name : LogsAside(data))
    done.findings.push_back({Finding::Kind::kAside, "a damaged log of the database was set aside as " + name,
                             "Push again what came after it, or restore a newer backup; then remove it.", false});
}

}  // namespace

bool HasLostCommits(const fs::path& data) { return !LogsAside(data).empty() || LogThatWent(data).has_value(); }

Result<bool> CheckLog(const FsckOptions& options, FsckDone& done) {
  TellOfLogsAside(options.place.folder, done);
  const auto damage = FindLogDamage(options.place.folder);
  if (const auto went = LogThatWent(options.place.folder); went && !damage)
    done.findings.push_back({Finding::Kind::kLog, went->what, went->cure, false});
  if (const auto doubt = LogInDoubt(options.place.folder); doubt && !IsInUse(options))
    done.findings.push_back({Finding::Kind::kLog, doubt->what, doubt->cure, false});
  if (!damage) return true;
  const Error error = ErrorOf(*damage, options.place.folder);
  Finding finding{Finding::Kind::kLog, error.what, error.cure};
  const bool can_go_on = options.repair && damage->kind != LogDamage::Kind::kHalfStored;
  if (can_go_on && damage->kind == LogDamage::Kind::kGone) {
    finding = GoOnWithout(options.place.folder, finding);
  } else if (can_go_on) {
    RIGCAL_ASSIGN(finding, SetAside(*damage, options.place.folder, finding));
  }
  done.findings.push_back(finding);
  return can_go_on;
}

}  // namespace rigcal::storage
