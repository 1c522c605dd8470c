// Is a file the kind of picture or cloud that its name says? Nothing is decoded.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace rigcal::formats {

// Compares the first bytes with the suffix of `path` (one of SuffixesOf()). A .bin or .csv has no mark of its own:
// anything passes. Errors call the file `path`.
[[nodiscard]] Status CheckPayloadKind(const std::filesystem::path& file, const std::string& path);

}  // namespace rigcal::formats
