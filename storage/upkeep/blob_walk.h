// What lies in a folder of content-addressed files.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "server/base/result.h"

namespace rigcal::storage {

enum class BlobFileKind {
  kBlob,      // named by a digest
  kSetAside,  // "<digest>.damaged", "<digest>.damaged.2", ...
  kHalf,      // was being written when a process ended
  kForeign,   // not of rigcal
};
// By its name alone.
[[nodiscard]] BlobFileKind KindOfBlobFile(const std::string& name);

// Every regular file of the shards of `blob_folder`, in no order. What comes or goes meanwhile may be missed. The error
// names a shard that cannot be read.
[[nodiscard]] Status ForEachBlobFile(
    const std::filesystem::path& blob_folder,
    const std::function<void(const std::filesystem::directory_entry&, BlobFileKind)>& visit);

}  // namespace rigcal::storage
