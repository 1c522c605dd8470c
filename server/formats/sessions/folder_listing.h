// What is in a folder, with nothing followed out of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::formats {

struct ListedEntry {
  enum class Kind { kFile, kFolder, kOther };
  std::string name;
  Kind kind = Kind::kOther;
  std::int64_t size_bytes = 0;  // of a file
};

// Entries of `folder` sorted by name, without those that begin with '.'. A symbolic link is taken for what it points
// to, which must exist and lie in `root`. Errors name the entry relative to `root`.
[[nodiscard]] Result<std::vector<ListedEntry>> ListFolder(const std::filesystem::path& folder,
                                                          const std::filesystem::path& root);

}  // namespace rigcal::formats
