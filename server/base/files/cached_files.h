// A stream of files that are written once: only the newest stay in the page cache until they are read. Else a flood
// takes ever fresh memory from everything else, and on a virtual machine each fresh page has to be asked of the host
// first.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>

namespace rigcal {

// One thread at a time.
class CachedFiles {
 public:
  // `bytes_max`: how much of the newest files may stay cached, in all.
  explicit CachedFiles(std::int64_t bytes_max) : bytes_max_(bytes_max) {}
  // A synced file that is not written any more. Lets the oldest go beyond the limit; whether the system heeds it
  // changes no result.
  void Add(const std::filesystem::path& path);

 private:
  struct File {
    std::filesystem::path path;
    std::int64_t bytes;
  };
  std::int64_t bytes_max_, bytes_ = 0;
  std::deque<File> files_;
};

}  // namespace rigcal
