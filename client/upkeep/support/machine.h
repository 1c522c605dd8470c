// What a support bundle says of the machine: of its system, its disk, what the service manager logged.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace rigcal::client {

// Kernel, processors, load, memory, the disk of `data`, as lines of text. What cannot be found out is said there.
[[nodiscard]] std::string MachineText(const std::filesystem::path& data);
// The end of the file, whole lines; of an empty path what journald has of the service rigcald. kNotFound, kStorage.
[[nodiscard]] Result<std::string> LastLog(const std::filesystem::path& file);

}  // namespace rigcal::client
