// What no row names, and what rows name and is not there but is drawn again.
#include <sys/stat.h>

#include "storage/files/folder_lock.h"
#include "storage/revisions/revisions.h"
#include "storage/upkeep/fsck.h"
#include "storage/upkeep/named_blobs.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kOldNs = 86'400'000'000'000;  // a day
constexpr std::size_t kNamedMax = 5;
constexpr int kRobotsAtOnce = 256;

struct Heap {
  std::vector<fs::path> files;
  std::int64_t bytes = 0;
  void Add(const fs::directory_entry& entry) {
    std::error_code failed;
    files.push_back(entry.path());
    const auto size = entry.file_size(failed);
    bytes += failed ? 0 : static_cast<std::int64_t>(size);
  }
  [[nodiscard]] std::string Text(const std::string& what) const {
    std::string text = std::to_string(files.size()) + " " + what + " (" + std::to_string(bytes) + " bytes):";
    for (std::size_t i = 0; i < std::min(files.size(), kNamedMax); ++i) text += " " + files[i].filename().string();
    return files.size() > kNamedMax ? text + " ..." : text;
  }
};

// Since its name or its content changed: a file that was moved into place today is of today.
bool IsOld(const fs::path& file, Stamp now) {
  struct stat info = {};
  if (::stat(file.c_str(), &info) != 0) return false;
  const std::int64_t changed_ns = static_cast<std::int64_t>(info.st_ctim.tv_sec) * 1'000'000'000 + info.st_ctim.tv_nsec;
  return now.ns - changed_ns > kOldNs;
}

struct Heaps {
  Heap old, young, aside;
  std::int64_t named = 0;  // files that rows name
};

Result<Heaps> Sort(Store& store, Stamp now) {
  RIGCAL_ASSIGN(const NamedBlobs named, LoadNamedBlobs(store.connection()));
  Heaps heaps;
  RIGCAL_TRY(ForEachBlobFile(store.BlobFolder(), [&](const fs::directory_entry& entry, BlobFileKind kind) {
    const std::string name = entry.path().filename().string();
    if (kind == BlobFileKind::kSetAside) return heaps.aside.Add(entry);
    if (kind == BlobFileKind::kForeign) return;
    if (kind == BlobFileKind::kBlob && named.contains(Digest(name))) {
      ++heaps.named;
      return;
    }
    (IsOld(entry.path(), now) ? heaps.old : heaps.young).Add(entry);
  }));
  return heaps;
}

std::int64_t Remove(const Heap& heap) {
  std::int64_t removed = 0;
  std::error_code failed;
  for (const fs::path& file : heap.files) removed += fs::remove(file, failed) ? 1 : 0;
  return removed;
}

Finding OfOld(const Heaps& heaps, const FsckOptions& options, const FsckDone& done) {
  const Heap& heap = heaps.old;
  Finding finding{Finding::Kind::kOrphan, heap.Text("files older than a day that nothing refers to"),
                  "`rigcal fsck --repair` removes them.", false};
  if (heaps.named == 0) {
    finding.cure = "No row names any file of this folder: they may be another store's, and are left.";
    return finding;
  }
  if (!options.repair) return finding;
  if (done.unmended() > 0) {
    finding.cure = "They are left while the database is damaged: a damaged row may be the one that names them.";
    return finding;
  }
  if (HasLostCommits(options.place.folder)) {
    finding.cure = "They are left: the log that was lost may have named them.";
    return finding;
  }
  finding.is_mended = Remove(heap) == static_cast<std::int64_t>(heap.files.size());
  finding.cure =
      finding.is_mended ? "They were removed." : "Some could not be removed: check the permissions of the folder.";
  return finding;
}

// Whoever repairs has the folder locked for itself.
Finding OfYoung(const Heap& heap, const FsckOptions& options) {
  const bool is_served = !options.repair && IsFolderInUse(options.place.folder);
  return {Finding::Kind::kOrphan, heap.Text("files of the last day that nothing refers to yet"),
          is_served
              ? "Nothing is to be done: a push may be under way."
              : "No server runs: a push that was broken off has left them, which goes on by itself when its robot "
                "pushes again, or rows were lost that named them.",
          false};
}

}  // namespace

Status CheckOrphans(Store& store, const FsckOptions& options, Stamp now, FsckDone& done) {
  RIGCAL_ASSIGN(const Heaps heaps, Sort(store, now));
  if (!heaps.old.files.empty()) done.findings.push_back(OfOld(heaps, options, done));
  if (!heaps.young.files.empty()) done.findings.push_back(OfYoung(heaps.young, options));
  if (!heaps.aside.files.empty())
    done.findings.push_back({Finding::Kind::kAside, heaps.aside.Text("damaged files that were set aside"),
                             "Check the disk; remove them once their sessions are whole again.", false});
  return {};
}

Status CheckReports(Store& store, const FsckOptions& options, FsckDone& done) {
  RobotId after;
  while (true) {
    RIGCAL_ASSIGN(const auto newest, LoadNewestRevisions(store, after, kRobotsAtOnce));
    if (newest.empty()) return {};
    after = newest.back().robot;
    for (const RevisionKey& key : newest) {
      std::error_code failed;
      if (key.number == 0 ||
          fs::exists(store.ReportFolder() / key.robot.str() / std::to_string(key.number) / "index.html", failed))
        continue;
      if (options.repair) RIGCAL_TRY(QueuePublication(store, key));
      done.findings.push_back(
          {Finding::Kind::kReport,
           "the report of revision " + std::to_string(key.number) + " of robot " + key.robot.str() + " is not there",
           "The server draws it again when it starts, or when somebody asks for it.", false, options.repair});
    }
  }
}

}  // namespace rigcal::storage
