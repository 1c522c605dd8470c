#include "storage/move/copy_files.h"

#include "storage/upkeep/named_blobs.h"

namespace rigcal::storage {
namespace {

Result<bool> IsThere(const std::filesystem::path& blobs, const Digest& digest) {
  if (!HasBlob(blobs, digest)) return false;
  RIGCAL_ASSIGN(const BlobState state, LookAtBlob(blobs, digest));
  return state == BlobState::kGood;
}

}  // namespace

Status CopyFiles(Connection& rows, const std::filesystem::path& from, const std::filesystem::path& to,
                 const MoveOptions& options, Moved& moved) {
  RIGCAL_ASSIGN(const NamedBlobs named, LoadNamedBlobs(rows));
  std::int64_t looked_at = 0;
  for (const auto& [digest, blob] : named) {
    options.progress(MoveStage::kCopyingFiles, looked_at++, static_cast<std::int64_t>(named.size()));
    RIGCAL_ASSIGN(const bool is_there, IsThere(to, digest));
    Copied copied{BlobState::kGood, 0};
    if (!is_there) {
      RIGCAL_ASSIGN(copied, CopyVerified(BlobPath(from, digest), BlobPath(to, digest), digest, options.how));
    }
    moved.files += copied.state == BlobState::kGood ? 1 : 0;
    moved.copied_bytes += copied.bytes;
    if (copied.state == BlobState::kGood || !blob.is_input) continue;
    if (blob.is_known_lost) {
      ++moved.known_lost;
      continue;
    }
    RIGCAL_ASSIGN(const auto payloads, LoadPayloadsOf(rows, digest));
    moved.lost.push_back(TextOf(payloads) + " is in the store damaged or not at all");
  }
  return {};
}

}  // namespace rigcal::storage
