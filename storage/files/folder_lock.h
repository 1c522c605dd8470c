// Who uses a data folder: one rigcald, or several whose rows are in one database on a server.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/files/file_descriptor.h"
#include "server/base/result.h"

namespace rigcal::storage {

// Makes the folder and locks it until the process ends, also by kill -9. kConflict: another process has it.
[[nodiscard]] Status LockFolder(const std::filesystem::path& folder);
// The same, until what it gives is closed.
[[nodiscard]] Result<FileDescriptor> HoldFolder(const std::filesystem::path& folder);
// Whether a process has it locked, this one too; makes nothing.
[[nodiscard]] bool IsFolderInUse(const std::filesystem::path& folder);

// Makes the folder and shares it, until the process ends, with others that share it. Gives the name of this process
// among them, which is also that of its part of the intake: "bench-pc-2", `machine` with the smallest number that no
// other has, so that one which was killed has the same again. kConflict: another process has the folder for itself.
[[nodiscard]] Result<std::string> ShareFolder(const std::filesystem::path& folder, const std::string& machine);

}  // namespace rigcal::storage
