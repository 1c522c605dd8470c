#include "storage/s3/store_bucket.h"

#include "server/base/digests/secret.h"
#include "server/base/log.h"
#include "storage/database/query.h"
#include "storage/files/folders.h"
#include "storage/s3/bucket.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kShardsOfFolder = 256;

struct KnownBucket {
  std::string place, store_id;  // empty: none
};

KnownBucket BucketInStore(Connection& connection) {
  Query query(connection, "SELECT place, store_id FROM lease_bucket");
  return query.Step() ? KnownBucket{query.Text(0), query.Text(1)} : KnownBucket{};
}

Error Elsewhere(const StorePlace& place, const KnownBucket& known) {
  return {ErrorCode::kConflict,
          "the files of the store at " + NameOf(place) + " are in " + known.place +
              (place.bucket.empty() ? "" : ", not in " + place.bucket),
          "Give --blobs " + known.place + "."};
}

Status PutShard(const Bucket& bucket, const fs::path& shard, std::int64_t& put) {
  std::error_code code;
  for (fs::directory_iterator entry(shard, code), end; !code && entry != end; entry.increment(code)) {
    const Digest digest(entry->path().filename().string());
    if (!CheckDigest("sha256", digest.str())) continue;
    if (Sha256OfFile(entry->path()) != digest) continue;  // damaged: it is asked for again when it is needed
    RIGCAL_ASSIGN(const bool is_there, bucket.Has(digest));
    if (is_there) continue;
    RIGCAL_TRY(bucket.Put(digest, entry->path()));
    ++put;
  }
  if (!code) return {};
  return Fail(ErrorCode::kStorage, "the folder " + shard.string() + " cannot be read: " + code.message(),
              "Check the disk and the permissions of the folder.");
}

// Broken off, it goes on where it was the next time.
Status PutFolder(const Bucket& bucket, const fs::path& blob_folder) {
  std::int64_t put = 0;
  for (int shard = 0; shard < kShardsOfFolder; ++shard)
    RIGCAL_TRY(PutShard(bucket, ShardFolder(blob_folder, shard), put));
  if (put > 0) LogInfo(std::to_string(put) + " files of " + blob_folder.string() + " were put into " + bucket.name());
  return {};
}

Status BeginBucket(Connection& connection, const StorePlace& place, const Bucket& bucket) {
  RIGCAL_ASSIGN(const std::string owner, bucket.LoadOwner());
  if (!owner.empty())
    return Fail(ErrorCode::kConflict, "the bucket " + bucket.name() + " is that of another store",
                "Give another prefix with --blobs; or remove the object rigcal-store there, if that store is no more.");
  RIGCAL_TRY(PutFolder(bucket, BlobFolderOf(place.folder)));
  const std::string store_id = NewSecret();
  RIGCAL_TRY(bucket.PutOwner(store_id));
  Query(connection, "INSERT INTO lease_bucket VALUES (?, ?)").Bind(place.bucket, store_id).Run();
  return {};
}

}  // namespace

Result<Blobs> OpenBlobs(Connection& connection, const StorePlace& place) {
  const std::string subject = "the bucket of the store at " + NameOf(place);
  const fs::path folder = BlobFolderOf(place.folder);
  KnownBucket known;
  const auto look = [&]() -> Status {
    known = BucketInStore(connection);
    return {};
  };
  RIGCAL_TRY(connection.Load(subject, look));
  if (place.bucket.empty()) return known.place.empty() ? Blobs(folder) : Blobs(folder, Elsewhere(place, known));
  RIGCAL_ASSIGN(const auto bucket, Bucket::Open(place.bucket));
  if (known.place.empty())
    RIGCAL_TRY(connection.Append(subject, [&]() -> Status {
      RIGCAL_TRY(look());  // another process may have begun it just now
      return known.place.empty() ? BeginBucket(connection, place, *bucket) : Status();
    }));
  if (!known.place.empty() && known.place != place.bucket) return Fail(Elsewhere(place, known));
  return Blobs(folder, bucket);
}

Status CheckBlobs(Store& store) {
  RIGCAL_TRY(store.blobs().CheckUsable());
  const Bucket* const bucket = store.blobs().bucket();
  if (bucket == nullptr) return {};
  KnownBucket known;
  RIGCAL_TRY(store.connection().Load("the bucket of the store", [&]() -> Status {
    known = BucketInStore(store.connection());
    return {};
  }));
  return bucket->Check(known.store_id);
}

}  // namespace rigcal::storage
