// Which copy of a bag a folder's files are of. Two copies may share name, size, time of writing and ends, and one of
// them may be damaged in between.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "server/base/result.h"

namespace rigcal::importing {

struct BagCopy {
  std::string marks;   // of each file name, size, inode, and when it was written and changed last
  std::string sha256;  // of all bytes; empty: not read yet
};

// Without reading the files. Errors of bags::PartsOf.
[[nodiscard]] Result<BagCopy> MarksOf(const std::filesystem::path& bag);
// Whether `now` has the bytes of `before`; reads the files of `bag` only where their marks are others. Gives `now` the
// digest.
[[nodiscard]] Result<bool> HasBytesOf(const BagCopy& before, const std::filesystem::path& bag, BagCopy& now,
                                      const std::function<void(std::int64_t, std::int64_t)>& progress);
// Reads all of it. What a disk cannot read is passed over.
[[nodiscard]] Result<std::string> DigestOf(const std::filesystem::path& bag,
                                           const std::function<void(std::int64_t, std::int64_t)>& progress);
[[nodiscard]] std::string BagCopyJson(const BagCopy& copy);
[[nodiscard]] Result<BagCopy> ReadBagCopy(const std::string& text);

}  // namespace rigcal::importing
