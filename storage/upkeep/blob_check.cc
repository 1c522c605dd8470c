// Every content that rows name, held against its digest.
#include <SQLiteCpp/SQLiteCpp.h>

#include "server/base/process/parallel_for.h"
#include "storage/database/query.h"
#include "storage/files/blobs.h"
#include "storage/files/lost_blobs.h"
#include "storage/revisions/revisions.h"
#include "storage/upkeep/fsck.h"
#include "storage/upkeep/named_blobs.h"
#include "storage/work/jobs.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kAtOnce = 256;

struct Looked {
  Digest digest;
  NamedBlob named;
  Result<BlobState> state = BlobState::kGood;
};

std::string Word(BlobState state) { return state == BlobState::kDamaged ? "is damaged" : "is missing"; }

// Whose pictures they are, and where they are shown.
struct Shown {
  std::vector<EdgeId> edges;
  std::vector<RobotId> robots;
};
Result<Shown> LoadShown(Store& store, const Digest& digest) {
  return Load<Shown>(store, "the edges of " + digest.str(), [&]() -> Result<Shown> {
    Shown shown;
    Query query(store,
                "SELECT e.edge_id, e.robot_id FROM edge_evidence v JOIN edge e ON e.number = v.edge_number "
                "WHERE v.digest = ? GROUP BY e.number, e.edge_id, e.robot_id ORDER BY e.number");
    query.Bind(digest);
    while (query.Step()) {
      shown.edges.push_back(query.IdAt<EdgeId>(0));
      shown.robots.push_back(query.IdAt<RobotId>(1));
    }
    return shown;
  });
}

// The jobs run again and the reports are drawn again.
Status MakeAgain(Store& store, const Digest& digest, const Shown& shown) {
  RIGCAL_TRY(SetDamagedAside(store.BlobFolder(), digest));
  return store.Write([&]() -> Status {
    for (const EdgeId& edge : shown.edges) RIGCAL_TRY(QueueAgain(store, edge));
    for (const RobotId& robot : shown.robots) RIGCAL_TRY(PublishAgain(store, robot));
    return {};
  });
}

// Of no edge: the next search of that picture makes it, and nobody is shown it until then.
Finding OfUnshown(const Looked& looked) {
  return {Finding::Kind::kDerived,
          "a picture of what a detector found, which no edge shows, " + Word(*looked.state) + " (blob " +
              looked.digest.str() + ")",
          "Nothing is to be done: it is made again when it is needed.", false};
}

Result<Finding> OfDerived(Store& store, const FsckOptions& options, const Looked& looked) {
  RIGCAL_ASSIGN(const Shown shown, LoadShown(store, looked.digest));
  if (options.repair) RIGCAL_TRY(MakeAgain(store, looked.digest, shown));
  if (shown.edges.empty()) return OfUnshown(looked);
  return Finding{
      Finding::Kind::kDerived,
      "a picture or document of edge " + shown.edges.front().str().substr(0, 16) + " of robot " +
          shown.robots.front().str() + " " + Word(*looked.state) + " (blob " + looked.digest.str() + ")",
      options.repair ? "The server makes it again when it runs." : "`rigcal fsck --repair` has it made again.", true,
      options.repair};
}

// An input that is known to be lost waits to be pushed, however long that takes.
Result<Finding> OfInput(Store& store, const FsckOptions& options, const Looked& looked, Stamp now) {
  const auto payloads = LoadPayloadsOf(store.connection(), looked.digest);  // a damaged database may not tell
  if (options.repair) {
    RIGCAL_TRY(SetDamagedAside(store.BlobFolder(), looked.digest));
    RIGCAL_TRY(AppendLost(store, looked.digest, *looked.state, std::nullopt, now));
  }
  const bool is_lost = options.repair || looked.named.is_known_lost;
  Finding finding{Finding::Kind::kInput,
                  TextOf(payloads.value_or(std::vector<NamedPayload>())) + " " + Word(*looked.state) + " (blob " +
                      looked.digest.str() + ")",
                  is_lost ? "Push the session again: only what is lost is sent."
                          : "Run `rigcal fsck --repair`, then push the session again: only what is lost is sent."};
  finding.is_lost = is_lost;
  return finding;
}

Status AddFinding(Store& store, const FsckOptions& options, const Looked& looked, Stamp now, FsckDone& done) {
  RIGCAL_TRY(looked.state);
  if (*looked.state == BlobState::kGood) {
    std::error_code failed;
    const auto bytes = fs::file_size(BlobPath(store.BlobFolder(), looked.digest), failed);
    ++done.blobs;
    done.blob_bytes += failed ? 0 : static_cast<std::int64_t>(bytes);
    return {};
  }
  auto finding = looked.named.is_input ? OfInput(store, options, looked, now) : OfDerived(store, options, looked);
  if (!finding) return Fail(finding.error());
  done.findings.push_back(std::move(*finding));
  return {};
}

// As many at once as the machine has processors.
Status LookAtAll(const fs::path& blob_folder, std::vector<Looked>& all, const FsckOptions& options,
                 const std::function<Status(const Looked&)>& add) {
  for (std::size_t begin = 0; begin < all.size(); begin += kAtOnce) {
    const std::size_t end = std::min(all.size(), begin + kAtOnce);
    ParallelFor(end - begin,
                [&](std::size_t i) { all[begin + i].state = LookAtBlob(blob_folder, all[begin + i].digest); });
    for (std::size_t i = begin; i < end; ++i) RIGCAL_TRY(add(all[i]));
    options.progress(static_cast<std::int64_t>(end), static_cast<std::int64_t>(all.size()));
  }
  return {};
}

}  // namespace

Status CheckBlobs(Store& store, const FsckOptions& options, Stamp now, FsckDone& done) {
  RIGCAL_ASSIGN(const NamedBlobs named, LoadNamedBlobs(store.connection()));
  std::vector<Looked> all;
  for (const auto& [digest, blob] : named) all.push_back({digest, blob});
  return LookAtAll(store.BlobFolder(), all, options,
                   [&](const Looked& looked) { return AddFinding(store, options, looked, now, done); });
}

Status CheckBlobFiles(const fs::path& blob_folder, const FsckOptions& options, FsckDone& done) {
  std::vector<Looked> all;
  RIGCAL_TRY(ForEachBlobFile(blob_folder, [&](const fs::directory_entry& entry, BlobFileKind kind) {
    if (kind == BlobFileKind::kBlob) all.push_back({Digest(entry.path().filename().string()), {}});
  }));
  return LookAtAll(blob_folder, all, options, [&](const Looked& looked) -> Status {
    RIGCAL_TRY(looked.state);
    done.blobs += *looked.state == BlobState::kGood ? 1 : 0;
    if (*looked.state == BlobState::kDamaged)
      done.findings.push_back({Finding::Kind::kInput, "a file is damaged (blob " + looked.digest.str() + ")",
                               "What it is the database would tell: restore that first."});
    return {};
  });
}

}  // namespace rigcal::storage
