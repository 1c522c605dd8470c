// The end of what WriteDurably does (durable_file.h), for a file that was written in pieces.
#pragma once

#include <filesystem>

#include "server/base/files/file_descriptor.h"
#include "server/base/result.h"

namespace rigcal {

// Syncs `file`, which is open as `temporary`, gives it the name `path` in the same file system, in the place of what
// has it, and syncs the folder. kStorage names `path`.
[[nodiscard]] Status MoveDurably(FileDescriptor file, const std::filesystem::path& temporary,
                                 const std::filesystem::path& path);

}  // namespace rigcal
