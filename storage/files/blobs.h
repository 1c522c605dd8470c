// Content-addressed files: BlobFolder()/ab/abcdef.... A blob is durable and complete, or absent.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/digests/sha256.h"
#include "storage/store.h"

namespace rigcal::storage {

class Bucket;

// Where contents are: in a folder; or durable in a bucket (s3/bucket.h), and what this machine has used of them in the
// folder as well. Any thread.
class Blobs {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): a folder alone is such a place
  Blobs(std::filesystem::path folder) : folder_(std::move(folder)) {}
  // `store_id`: what the bucket has as its store.
  Blobs(std::filesystem::path folder, std::shared_ptr<const Bucket> bucket, std::string store_id)
      : folder_(std::move(folder)), bucket_(std::move(bucket)), store_id_(std::move(store_id)) {}
  // They are elsewhere: whatever is asked of them is this error, kUnreachable.
  Blobs(std::filesystem::path folder, Error why_not) : folder_(std::move(folder)), why_not_(std::move(why_not)) {}

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  [[nodiscard]] const Bucket* bucket() const { return bucket_.get(); }  // null: none
  [[nodiscard]] const std::string& store_id() const { return store_id_; }
  [[nodiscard]] Status CheckUsable() const { return why_not_ ? Status(Fail(*why_not_)) : Status(); }

 private:
  std::filesystem::path folder_;
  std::shared_ptr<const Bucket> bucket_;
  std::string store_id_;
  std::optional<Error> why_not_;
};

// Of each of these that takes Blobs: kUnreachable where the bucket cannot be asked, of which nothing follows for the
// content.

// blob_folder/ab for shard 0xab, 0 to 255. Store::Open makes them all, so that a push need not.
[[nodiscard]] std::filesystem::path ShardFolder(const std::filesystem::path& blob_folder, int shard);
[[nodiscard]] std::filesystem::path BlobPath(const std::filesystem::path& blob_folder, const Digest& digest);
[[nodiscard]] bool HasBlob(const std::filesystem::path& blob_folder, const Digest& digest);
// Whether the folder has it now: what only the bucket has is fetched first. kConflict: what the bucket has are not the
// bytes that it was given.
[[nodiscard]] Result<bool> FetchBlob(const Blobs& blobs, const Digest& digest);
// Writes bytes as a durable blob; a no-op if it is there.
[[nodiscard]] Result<Digest> AppendBlob(const Blobs& blobs, std::string_view bytes);
// Moves complete, already fsynced files (same file system) to their places, then fsyncs each touched folder once, and
// puts them into the bucket, several at once.
struct FinishedFile {
  std::filesystem::path path;
  Digest digest;
};
// One that is gone and whose blob is there counts as moved. kStorage names what cannot be moved.
[[nodiscard]] Status AdoptBlobs(const Blobs& blobs, const std::vector<FinishedFile>& files);
// The same; those in `put` are in the bucket already, and what comes there is added, also where others do not: a repeat
// goes on from there.
[[nodiscard]] Status AdoptBlobs(const Blobs& blobs, const std::vector<FinishedFile>& files, std::set<Digest>& put);
// The whole blob, held against its name; refuses more than bytes_max. kNotFound: there is none; kConflict: its bytes
// are not those that it was stored with.
[[nodiscard]] Result<std::string> LoadBlob(const Blobs& blobs, const Digest& digest, std::size_t bytes_max);

// What is left of a blob. Of a disk that cannot be asked (permissions, say) an error.
enum class BlobState { kGood, kDamaged, kMissing };
// Reads the whole blob and holds it against its name; changes nothing but that it fetches what the folder lacks.
[[nodiscard]] Result<BlobState> LookAtBlob(const Blobs& blobs, const Digest& digest);
// The same, and moves a damaged one aside, to a name ending in ".damaged" that is not taken: from then on it is
// missing. Where the bucket has it good, so it is.
[[nodiscard]] Result<BlobState> SetDamagedAside(const Blobs& blobs, const Digest& digest);

}  // namespace rigcal::storage
