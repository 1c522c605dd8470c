#include "storage/files/blobs.h"

#include <array>
#include <set>
#include <system_error>

#include "server/base/files/durable_file.h"
#include "server/base/files/file_descriptor.h"

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

Result<Digest> AppendBlob(const fs::path& blob_folder, std::string_view bytes) {
  const Digest digest = Sha256Of(bytes);
  RIGCAL_ASSIGN(const fs::path shard, MakeShard(blob_folder, digest));
  if (HasBlob(blob_folder, digest)) {
    RIGCAL_TRY(SyncFolder(shard));  // who made it may be at that yet, or have failed
    return digest;
  }
  RIGCAL_TRY(WriteDurably(shard / digest.str(), bytes));
  return digest;
}

Status AdoptBlobs(const fs::path& blob_folder, const std::vector<FinishedFile>& files) {
  std::set<fs::path> touched;
  for (const FinishedFile& file : files) {
    RIGCAL_ASSIGN(const fs::path shard, MakeShard(blob_folder, file.digest));
    RIGCAL_TRY(Move(file, shard / file.digest.str()));
    touched.insert(shard);
  }
  for (const fs::path& folder : touched) RIGCAL_TRY(SyncFolder(folder));
  return {};
}

Result<std::string> LoadBlob(const fs::path& blob_folder, const Digest& digest, std::size_t bytes_max) {
  RIGCAL_TRY(CheckDigest("sha256", digest.str()));
  const fs::path path = BlobPath(blob_folder, digest);
  RIGCAL_ASSIGN(std::string bytes, ReadFile(path, bytes_max));
  if (Sha256Of(bytes) == digest) return bytes;
  return Fail(ErrorCode::kConflict, path.string() + ": its bytes are not those that it was stored with",
              "Push the session again that it belongs to, and check the disk.");
}

Result<BlobState> LookAtBlob(const fs::path& blob_folder, const Digest& digest) {
  RIGCAL_TRY(CheckDigest("sha256", digest.str()));
  const fs::path path = BlobPath(blob_folder, digest);
  const Result<FileDescriptor> file = OpenToRead(path);
  if (!file && file.error().code == ErrorCode::kNotFound) return BlobState::kMissing;
  if (!file) return Fail(file.error());
  const Result<Digest> found = Sha256OfFile(path);  // what can be opened but not be read is damaged as well
  return found && *found == digest ? BlobState::kGood : BlobState::kDamaged;
}

Result<BlobState> SetDamagedAside(const fs::path& blob_folder, const Digest& digest) {
  RIGCAL_ASSIGN(const BlobState state, LookAtBlob(blob_folder, digest));
  if (state != BlobState::kDamaged) return state;
  const fs::path path = BlobPath(blob_folder, digest);
  const fs::path aside = FreeName(path.string() + ".damaged");
  std::error_code code;
  fs::rename(path, aside, code);
  if (code == std::errc::no_such_file_or_directory) return BlobState::kMissing;  // another thread was faster
  if (code)
    return Fail(ErrorCode::kStorage,
                "cannot move the damaged " + path.string() + " to " + aside.string() + ": " + code.message(), kCure);
  RIGCAL_TRY(SyncFolder(path.parent_path()));
  return state;
}

}  // namespace rigcal::storage
