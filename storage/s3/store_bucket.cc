#include "storage/s3/store_bucket.h"

#include <set>

#include "server/base/digests/secret.h"
#include "server/base/digests/sha256.h"
#include "server/base/log.h"
#include "server/base/process/service_manager.h"
#include "storage/database/query.h"
#include "storage/files/folders.h"
#include "storage/files/lost_blobs.h"
#include "storage/s3/bucket.h"
#include "storage/work/servers.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kShardsOfFolder = 256;
constexpr const char* kStillBeginning = "EXTEND_TIMEOUT_USEC=600000000";  // for one file of the largest size

struct KnownBucket {
  std::string place, store_id;  // empty: none
};

KnownBucket ReadKnown(Connection& connection, const std::string& table) {
  Query query(connection, "SELECT place, store_id FROM " + table);
  return query.Step() ? KnownBucket{query.Text(0), query.Text(1)} : KnownBucket{};
}

KnownBucket BucketInStore(Connection& connection) { return ReadKnown(connection, "lease_bucket"); }
KnownBucket BegunInStore(Connection& connection) { return ReadKnown(connection, "lease_bucket_begun"); }

// Also one that the files are still put into.
KnownBucket BucketOrBegun(Connection& connection) {
  const KnownBucket known = BucketInStore(connection);
  return known.place.empty() ? BegunInStore(connection) : known;
}

Error Elsewhere(const StorePlace& place, const KnownBucket& known, ErrorCode code) {
  return {code,
          "the files of the store at " + NameOf(place) + " are in " + known.place +
              (place.bucket.empty() ? "" : ", not in " + place.bucket),
          "Give --blobs " + known.place + "."};
}

Error OfAnotherStore(const Bucket& bucket) {
  return {ErrorCode::kConflict, "the bucket " + bucket.name() + " is that of another store",
          "Give another prefix with --blobs; or remove the object rigcal-store there, if that store is no more."};
}

struct LostContent {
  Digest digest;
  BlobState state = BlobState::kMissing;
};

// Puts what a folder has into a bucket. Broken off, it goes on where it was the next time.
class FolderUpload {
 public:
  FolderUpload(const Bucket& bucket, fs::path blob_folder) : bucket_(bucket), folder_(std::move(blob_folder)) {}

  [[nodiscard]] Status Run() {
    for (int shard = 0; shard < kShardsOfFolder; ++shard) RIGCAL_TRY(PutShard(ShardFolder(folder_, shard)));
    if (put_ > 0) LogInfo(std::to_string(put_) + " files of " + folder_.string() + " were put into " + bucket_.name());
    return {};
  }

  // Of `held`, what neither of them has.
  [[nodiscard]] Result<std::vector<LostContent>> FindLost(const std::vector<Digest>& held) const {
    std::vector<LostContent> lost;
    for (const Digest& digest : held) {
      const bool is_damaged = damaged_.contains(digest);
      if (!is_damaged && HasBlob(folder_, digest)) continue;
      RIGCAL_ASSIGN(const bool is_there, bucket_.Has(digest));
      if (!is_there) lost.push_back({digest, is_damaged ? BlobState::kDamaged : BlobState::kMissing});
    }
    return lost;
  }

 private:
  [[nodiscard]] Status PutShard(const fs::path& shard) {
    std::error_code code;
    for (fs::directory_iterator entry(shard, code), end; !code && entry != end; entry.increment(code))
      if (const Digest digest(entry->path().filename().string()); CheckDigest("sha256", digest.str()))
        RIGCAL_TRY(PutFile(digest, entry->path()));
    if (!code) return {};
    return Fail(ErrorCode::kStorage, "the folder " + shard.string() + " cannot be read: " + code.message(),
                "Check the disk and the permissions of the folder.");
  }

  // What cannot be read may be readable later: without it the bucket is not begun.
  [[nodiscard]] Status PutFile(const Digest& digest, const fs::path& file) {
    TellServiceManager(kStillBeginning);
    RIGCAL_ASSIGN(const bool is_there, bucket_.Has(digest));
    if (is_there) return {};
    RIGCAL_ASSIGN(const Digest found, Sha256OfFile(file));
    if (found != digest) {
      damaged_.insert(digest);
      return {};
    }
    RIGCAL_TRY(bucket_.Put(digest, file));
    ++put_;
    return {};
  }

  const Bucket& bucket_;
  const fs::path folder_;
  std::int64_t put_ = 0;
  std::set<Digest> damaged_;
};

Status RefuseOthersAtWork(Connection& connection, const StorePlace& place) {
  if (place.server.empty() || !IsAtWork(connection)) return {};  // of SQLite one process has the folder
  return Fail(ErrorCode::kConflict,
              "a rigcald or a rigcal-worker uses the store at " + NameOf(place) + ", whose files are to be put into " +
                  place.bucket,
              "Stop all of them, wait a minute where one was killed, and start them with --blobs.");
}

// From here on nobody who has no bucket adds to the store. Empty: another process has done it all.
Result<KnownBucket> NoteBegun(Connection& connection, const StorePlace& place, const Bucket& bucket,
                              const std::string& owner) {
  if (!BucketInStore(connection).place.empty()) return KnownBucket{};
  RIGCAL_TRY(RefuseOthersAtWork(connection, place));
  const KnownBucket begun = BegunInStore(connection);
  const bool is_begun = begun.place == place.bucket;
  if (!owner.empty() && (!is_begun || owner != begun.store_id)) return Fail(OfAnotherStore(bucket));
  if (is_begun) return begun;
  Query(connection, "DELETE FROM lease_bucket_begun").Run();  // one that nothing came into but copies
  const KnownBucket ours{place.bucket, NewSecret()};
  Query(connection, "INSERT INTO lease_bucket_begun VALUES (?, ?)").Bind(ours.place, ours.store_id).Run();
  return ours;
}

Status NoteDone(Connection& connection, const StorePlace& place, const KnownBucket& ours,
                const std::vector<LostContent>& lost) {
  if (!BucketInStore(connection).place.empty()) return {};
  if (const KnownBucket begun = BegunInStore(connection); begun.store_id != ours.store_id)
    return Fail(Elsewhere(place, begun, ErrorCode::kConflict));
  Query clock(connection, "SELECT now_ns FROM store_clock");
  const Stamp now = clock.Step() ? clock.Time(0) : Stamp{};
  for (const LostContent& one : lost) NoteLost(connection, one.digest, one.state, now);
  Query(connection, "INSERT INTO lease_bucket VALUES (?, ?)").Bind(ours.place, ours.store_id).Run();
  Query(connection, "DELETE FROM lease_bucket_begun").Run();
  return {};
}

Result<std::vector<Digest>> LoadAllHeld(Connection& connection, const std::string& subject) {
  std::vector<Digest> held;
  RIGCAL_TRY(connection.Load(subject, [&]() -> Status {
    Query query(connection, "SELECT DISTINCT digest FROM robot_digest_held ORDER BY digest");
    while (query.Step()) held.push_back(query.IdAt<Digest>(0));
    return {};
  }));
  return held;
}

// Uploads in no transaction. Killed at any point, the next begin goes on.
Status BeginBucket(Connection& connection, const StorePlace& place, const Bucket& bucket, const std::string& subject) {
  KnownBucket ours;
  RIGCAL_ASSIGN(const std::string owner, bucket.LoadOwner());
  RIGCAL_TRY(connection.Append(subject, [&]() -> Status {
    RIGCAL_ASSIGN(ours, NoteBegun(connection, place, bucket, owner));
    return {};
  }));
  if (ours.place.empty()) return {};
  FolderUpload upload(bucket, BlobFolderOf(place.folder));
  RIGCAL_TRY(upload.Run());
  RIGCAL_ASSIGN(const std::vector<Digest> held, LoadAllHeld(connection, subject));
  RIGCAL_ASSIGN(const std::vector<LostContent> lost, upload.FindLost(held));
  if (!lost.empty())
    LogWarn(std::to_string(lost.size()) + " files that robots pushed are not in " + bucket.name() +
            ": the data folder had lost or damaged them. /api/v1/health names them; push their sessions again.");
  RIGCAL_TRY(bucket.PutOwner(ours.store_id));
  RIGCAL_ASSIGN(const std::string now_owner, bucket.LoadOwner());
  if (now_owner != ours.store_id) return Fail(OfAnotherStore(bucket));  // begun at the same time
  return connection.Append(subject, [&] { return NoteDone(connection, place, ours, lost); });
}

}  // namespace

Result<Blobs> OpenBlobs(Connection& connection, const StorePlace& place) {
  const std::string subject = "the bucket of the store at " + NameOf(place);
  const fs::path folder = BlobFolderOf(place.folder);
  KnownBucket known;
  const auto look = [&]() -> Status {
    known = place.bucket.empty() ? BucketOrBegun(connection) : BucketInStore(connection);
    return {};
  };
  RIGCAL_TRY(connection.Load(subject, look));
  if (place.bucket.empty())
    return known.place.empty() ? Blobs(folder) : Blobs(folder, Elsewhere(place, known, ErrorCode::kUnreachable));
  RIGCAL_ASSIGN(const auto bucket, Bucket::Open(place.bucket));
  if (known.place.empty()) {
    RIGCAL_TRY(BeginBucket(connection, place, *bucket, subject));
    RIGCAL_TRY(connection.Load(subject, look));
  }
  if (known.place != place.bucket) return Fail(Elsewhere(place, known, ErrorCode::kConflict));
  return Blobs(folder, bucket, known.store_id);
}

Status CheckBlobs(Store& store) {
  if (const Status usable = store.blobs().CheckUsable(); !usable)
    return Fail(ErrorCode::kConflict, usable.error().what, usable.error().cure);
  const Bucket* const bucket = store.blobs().bucket();
  return bucket == nullptr ? Status() : bucket->Check(store.blobs().store_id());
}

Status CheckBlobsStayed(Store& store) {
  if (store.blobs().bucket() != nullptr) return {};
  return store.connection().Load("the bucket of the store", [&]() -> Status {
    const KnownBucket known = BucketOrBegun(store.connection());
    return known.place.empty() ? Status() : Fail(Elsewhere(store.place(), known, ErrorCode::kUnreachable));
  });
}

}  // namespace rigcal::storage
