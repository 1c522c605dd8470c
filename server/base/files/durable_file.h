// Files that survive power loss: temp file, fsync, rename, fsync of the folder.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "server/base/result.h"

namespace rigcal {

// fsync of a file, of a folder's entries. The error names the path: kNotFound or kStorage.
[[nodiscard]] Status SyncFile(const std::filesystem::path& path);
[[nodiscard]] Status SyncFolder(const std::filesystem::path& folder);
// Makes a folder that is missing, and those above it; durable when it returns. kStorage names what cannot be made.
[[nodiscard]] Status MakeFolderDurably(const std::filesystem::path& folder);
// Replaces `path` atomically with `bytes`; durable when it returns. A link is followed and stays. kInvalidInput where
// there is a device or a pipe.
[[nodiscard]] Status WriteDurably(const std::filesystem::path& path, std::string_view bytes);
// The whole file; refuses more than `bytes_max`. The error names the file.
[[nodiscard]] Result<std::string> ReadFile(const std::filesystem::path& path, std::size_t bytes_max);

}  // namespace rigcal
