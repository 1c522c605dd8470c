// Is a file the kind of picture that its name says? Nothing is decoded.
#pragma once

#include <filesystem>
#include <string>

#include "server/base/result.h"

namespace rigcal::formats {

// Compares the first bytes with the suffix of `path` (png, jpg or jpeg). Errors call the file `path`.
[[nodiscard]] Status CheckPicture(const std::filesystem::path& file, const std::string& path);

}  // namespace rigcal::formats
