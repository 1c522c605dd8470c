// One rigcald per data folder.
#pragma once

#include <filesystem>

#include "server/base/result.h"

namespace rigcal::storage {

// Makes the folder and locks it until the process ends, also by kill -9. kConflict: another process has it.
[[nodiscard]] Status LockFolder(const std::filesystem::path& folder);

}  // namespace rigcal::storage
