// Which files a bag consists of.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "server/base/result.h"

namespace rigcal::bags {

struct Parts {
  std::vector<std::filesystem::path> files;      // in the order in which they were recorded
  std::map<std::string, std::string> encodings;  // of topics, as metadata.yaml has it
  std::vector<Error> doubts;  // of metadata.yaml, where it cannot be read and the files are taken as they lie
};

// A file is one part. Of a folder: what its metadata.yaml lists; without one every .mcap, .db3 and .bag in it, with
// .zstd behind it or not, by the numbers in their names. kNotFound, kInvalidInput: there is none.
[[nodiscard]] Result<Parts> PartsOf(const std::filesystem::path& bag);

}  // namespace rigcal::bags
