#include "storage/upkeep/blob_walk.h"

#include "storage/files/blobs.h"

namespace rigcal::storage {
namespace {

namespace fs = std::filesystem;

constexpr int kShardCount = 256;

}  // namespace

BlobFileKind KindOfBlobFile(const std::string& name) {
  if (CheckDigest("sha256", name)) return BlobFileKind::kBlob;
  if (name.find(".tmp-") != std::string::npos) return BlobFileKind::kHalf;
  return name.find(".damaged") != std::string::npos ? BlobFileKind::kSetAside : BlobFileKind::kForeign;
}

Status ForEachBlobFile(const fs::path& blob_folder,
                       const std::function<void(const fs::directory_entry&, BlobFileKind)>& visit) {
  for (int shard = 0; shard < kShardCount; ++shard) {
    const fs::path folder = ShardFolder(blob_folder, shard);
    std::error_code code, ignored;
    if (!fs::exists(folder, ignored)) continue;
    for (fs::directory_iterator entry(folder, code), end; !code && entry != end; entry.increment(code))
      if (entry->is_regular_file(ignored)) visit(*entry, KindOfBlobFile(entry->path().filename().string()));
    if (code)
      return Fail(ErrorCode::kStorage, "the folder " + folder.string() + " cannot be read: " + code.message(),
                  "Check the disk and the permissions of the folder.");
  }
  return {};
}

}  // namespace rigcal::storage
