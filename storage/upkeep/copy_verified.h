// Copies of content-addressed files that are held against their names on the way.
#pragma once

#include <filesystem>

#include "storage/files/blobs.h"

namespace rigcal::storage {

enum class CopyHow {
  kCopy,  // bytes of its own
  kLink,  // the same bytes under another name, where both are on one file system; else a copy
};
struct Copied {
  BlobState state = BlobState::kMissing;  // of the source; only of a good one there is a file at the target
  std::int64_t bytes = 0;                 // that the target has of its own; 0 of a link
};
// `from` to `to`, whose folder is there, by way of a name beside `to` with ".tmp-"; replaces what is at `to`. The bytes
// are synced by nobody: sync the file system before it is counted on. The error names what cannot be written.
[[nodiscard]] Result<Copied> CopyVerified(const std::filesystem::path& from, const std::filesystem::path& to,
                                          const Digest& digest, CopyHow how);
// Everything that was written to the file system of `folder` until now is on disk.
[[nodiscard]] Status SyncFileSystem(const std::filesystem::path& folder);

}  // namespace rigcal::storage
