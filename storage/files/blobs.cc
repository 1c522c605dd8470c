#include "storage/files/blobs.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>

#include "server/base/files/durable_file.h"
#include "server/base/files/file_descriptor.h"
#include "server/base/limits.h"
#include "server/base/process/guarded.h"
#include "storage/files/fetched_file.h"
#include "storage/s3/bucket.h"

namespace rigcal::storage {
namespace fs = std::filesystem;
namespace {

constexpr const char* kCure = "Check that the disk has free space and that this user may write to the folder.";

Status Move(const FinishedFile& file, const fs::path& target) {
  std::error_code code;
  fs::rename(file.path, target, code);
  if (!code) return {};
  // The same file twice in a list, or moved before: the content is where it belongs.
  std::error_code ignored;
  if (code == std::errc::no_such_file_or_directory && fs::is_regular_file(target, ignored)) return {};
  return Fail(ErrorCode::kStorage,
              "cannot move " + file.path.string() + " to " + target.string() + ": " + code.message(), kCure);
}

// The shard of a digest, made durably if it is not there.
Result<fs::path> MakeShard(const fs::path& blob_folder, const Digest& digest) {
  RIGCAL_TRY(CheckDigest("sha256", digest.str()));
  const fs::path shard = BlobPath(blob_folder, digest).parent_path();
  std::error_code code;
  const bool made = fs::create_directory(shard, code);
  if (code) return Fail(ErrorCode::kStorage, "cannot make the folder " + shard.string() + ": " + code.message(), kCure);
  if (made) RIGCAL_TRY(SyncFolder(blob_folder));
  return shard;
}

// Several at once: each waits for the service most of the time. After a failure none is begun.
Status PutAll(const Bucket& bucket, const fs::path& blob_folder, const std::vector<FinishedFile>& files,
              std::set<Digest>& put) {
  constexpr std::size_t kAtOnceMax = 8;
  std::vector<Status> done(files.size());
  std::mutex mutex;
  std::atomic<std::size_t> next{0};
  std::atomic<bool> has_failed{false};
  const auto put_some = [&] {
    for (std::size_t i = next++; i < files.size() && !has_failed; i = next++) {
      done[i] = Guarded([&]() -> Status {
        {
          const std::lock_guard lock(mutex);
          if (put.contains(files[i].digest)) return {};
        }
        RIGCAL_TRY(bucket.Put(files[i].digest, BlobPath(blob_folder, files[i].digest)));
        const std::lock_guard lock(mutex);
        put.insert(files[i].digest);
        return {};
      });
      if (!done[i]) has_failed = true;
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (std::size_t i = 1; i < std::min(kAtOnceMax, files.size()); ++i) others.emplace_back(put_some);
    } catch (const std::exception&) {  // fewer will do
    }
    put_some();
  }
  for (const Status& one : done) RIGCAL_TRY(one);
  return {};
}

// False: the bucket has it not, and is still that of the store. Another one, at the same address, says nothing of it.
Result<bool> AbsentOf(const Blobs& blobs) {
  const Status is_ours = blobs.bucket()->CheckOwner(blobs.store_id());
  if (is_ours) return false;
  return Fail(ErrorCode::kUnreachable, is_ours.error().what, is_ours.error().cure);
}

// The name itself, or with a number: nothing that was set aside before is overwritten.
fs::path FreeName(const std::string& name) {
  std::error_code ignored;
  fs::path free = name;
  for (int i = 2; fs::exists(free, ignored); ++i) free = name + "." + std::to_string(i);
  return free;
}

}  // namespace

fs::path ShardFolder(const fs::path& blob_folder, int shard) {
  constexpr std::string_view kHex = "0123456789abcdef";
  const std::array<char, 3> name = {kHex[static_cast<std::size_t>(shard) / 16 % 16],
                                    kHex[static_cast<std::size_t>(shard) % 16], '\0'};
  return blob_folder / name.data();
}

fs::path BlobPath(const fs::path& blob_folder, const Digest& digest) {
  return blob_folder / digest.str().substr(0, 2) / digest.str();
}

bool HasBlob(const fs::path& blob_folder, const Digest& digest) {
  std::error_code code;
  return !digest.empty() && fs::is_regular_file(BlobPath(blob_folder, digest), code);
}

Result<bool> FetchBlob(const Blobs& blobs, const Digest& digest) {
  RIGCAL_TRY(blobs.CheckUsable());
  RIGCAL_TRY(CheckDigest("sha256", digest.str()));
  if (HasBlob(blobs.folder(), digest) || blobs.bucket() == nullptr) return HasBlob(blobs.folder(), digest);
  RIGCAL_ASSIGN(const fs::path shard, MakeShard(blobs.folder(), digest));
  FetchedFile file(shard / digest.str());
  const auto take = [&](std::int64_t at, std::string_view bytes) { return file.Take(at, bytes); };
  RIGCAL_ASSIGN(const bool is_there, blobs.bucket()->Get(digest, limits::kPayloadBytesMax, take));
  if (!is_there) return AbsentOf(blobs);
  if (file.Hash() != digest)
    return Fail(ErrorCode::kConflict,
                "blob " + digest.str() + " in " + blobs.bucket()->name() +
                    " has other bytes than those that it was stored with",
                "Push the session again that it belongs to.");
  RIGCAL_TRY(file.Keep());
  return true;
}

Result<Digest> AppendBlob(const Blobs& blobs, std::string_view bytes) {
  RIGCAL_TRY(blobs.CheckUsable());
  const Digest digest = Sha256Of(bytes);
  RIGCAL_ASSIGN(const fs::path shard, MakeShard(blobs.folder(), digest));
  const bool was_there = HasBlob(blobs.folder(), digest);
  if (was_there)
    RIGCAL_TRY(SyncFolder(shard));  // who made it may be at that yet, or have failed
  else
    RIGCAL_TRY(WriteDurably(shard / digest.str(), bytes));
  if (blobs.bucket() == nullptr) return digest;
  RIGCAL_ASSIGN(const bool is_put, was_there ? blobs.bucket()->Has(digest) : Result<bool>(false));
  if (!is_put) RIGCAL_TRY(blobs.bucket()->Put(digest, bytes));
  return digest;
}

Status AdoptBlobs(const Blobs& blobs, const std::vector<FinishedFile>& files) {
  std::set<Digest> put;
  return AdoptBlobs(blobs, files, put);
}

Status AdoptBlobs(const Blobs& blobs, const std::vector<FinishedFile>& files, std::set<Digest>& put) {
  RIGCAL_TRY(blobs.CheckUsable());
  std::set<fs::path> touched;
  for (const FinishedFile& file : files) {
    RIGCAL_ASSIGN(const fs::path shard, MakeShard(blobs.folder(), file.digest));
    RIGCAL_TRY(Move(file, shard / file.digest.str()));
    touched.insert(shard);
  }
  for (const fs::path& folder : touched) RIGCAL_TRY(SyncFolder(folder));
  return blobs.bucket() == nullptr ? Status() : PutAll(*blobs.bucket(), blobs.folder(), files, put);
}

Result<std::string> LoadBlob(const Blobs& blobs, const Digest& digest, std::size_t bytes_max) {
  RIGCAL_TRY(FetchBlob(blobs, digest));
  const fs::path path = BlobPath(blobs.folder(), digest);
  RIGCAL_ASSIGN(std::string bytes, ReadFile(path, bytes_max));
  if (Sha256Of(bytes) == digest) return bytes;
  if (blobs.bucket() != nullptr) {
    RIGCAL_ASSIGN(const BlobState state, SetDamagedAside(blobs, digest));
    if (state == BlobState::kGood) return ReadFile(path, bytes_max);
  }
  return Fail(ErrorCode::kConflict, path.string() + ": its bytes are not those that it was stored with",
              "Push the session again that it belongs to, and check the disk.");
}

Result<BlobState> LookAtBlob(const Blobs& blobs, const Digest& digest) {
  const Result<bool> is_there = FetchBlob(blobs, digest);
  if (!is_there && is_there.error().code == ErrorCode::kConflict && blobs.CheckUsable()) return BlobState::kDamaged;
  if (!is_there) return Fail(is_there.error());
  const fs::path path = BlobPath(blobs.folder(), digest);
  const Result<FileDescriptor> file = OpenToRead(path);
  if (!file && file.error().code == ErrorCode::kNotFound) return BlobState::kMissing;
  if (!file) return Fail(file.error());
  const Result<Digest> found = Sha256OfFile(path);  // what can be opened but not be read is damaged as well
  return found && *found == digest ? BlobState::kGood : BlobState::kDamaged;
}

Result<BlobState> SetDamagedAside(const Blobs& blobs, const Digest& digest) {
  RIGCAL_ASSIGN(const BlobState state, LookAtBlob(blobs, digest));
  const fs::path path = BlobPath(blobs.folder(), digest);
  if (state != BlobState::kDamaged || !HasBlob(blobs.folder(), digest)) return state;
  const fs::path aside = FreeName(path.string() + ".damaged");
  std::error_code code;
  fs::rename(path, aside, code);
  if (code == std::errc::no_such_file_or_directory) return BlobState::kMissing;  // another thread was faster
  if (code)
    return Fail(ErrorCode::kStorage,
                "cannot move the damaged " + path.string() + " to " + aside.string() + ": " + code.message(), kCure);
  RIGCAL_TRY(SyncFolder(path.parent_path()));
  if (blobs.bucket() == nullptr) return state;
  RIGCAL_ASSIGN(const BlobState fetched, LookAtBlob(blobs, digest));
  return fetched == BlobState::kGood ? fetched : state;
}

}  // namespace rigcal::storage
