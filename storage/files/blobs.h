// Content-addressed files: BlobFolder()/ab/abcdef.... A blob is durable and complete, or absent.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/base/digests/sha256.h"
#include "storage/store.h"

namespace rigcal::storage {

// blob_folder/ab for shard 0xab, 0 to 255. Store::Open makes them all, so that a push need not.
[[nodiscard]] std::filesystem::path ShardFolder(const std::filesystem::path& blob_folder, int shard);
[[nodiscard]] std::filesystem::path BlobPath(const std::filesystem::path& blob_folder, const Digest& digest);
[[nodiscard]] bool HasBlob(const std::filesystem::path& blob_folder, const Digest& digest);
// Writes bytes as a durable blob; a no-op if it is there.
[[nodiscard]] Result<Digest> AppendBlob(const std::filesystem::path& blob_folder, std::string_view bytes);
// Moves complete, already fsynced files (same file system) to their places, then fsyncs each touched folder once.
struct FinishedFile {
  std::filesystem::path path;
  Digest digest;
};
// One that is gone and whose blob is there counts as moved. kStorage names what cannot be moved.
[[nodiscard]] Status AdoptBlobs(const std::filesystem::path& blob_folder, const std::vector<FinishedFile>& files);
// The whole blob, held against its name; refuses more than bytes_max. kNotFound: there is none; kConflict: its bytes
// are not those that it was stored with.
[[nodiscard]] Result<std::string> LoadBlob(const std::filesystem::path& blob_folder, const Digest& digest,
                                           std::size_t bytes_max);

// What the disk has kept of a blob. Of a disk that cannot be asked (permissions, say) an error.
enum class BlobState { kGood, kDamaged, kMissing };
// Reads the whole blob and holds it against its name; changes nothing.
[[nodiscard]] Result<BlobState> LookAtBlob(const std::filesystem::path& blob_folder, const Digest& digest);
// The same, and moves a damaged one aside, to a name ending in ".damaged" that is not taken: from then on it is
// missing.
[[nodiscard]] Result<BlobState> SetDamagedAside(const std::filesystem::path& blob_folder, const Digest& digest);

}  // namespace rigcal::storage
