// A file that is unpacked for as long as it is read.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "server/base/result.h"

namespace rigcal::bags {

// Removes the file when it goes.
class TemporaryFile {
 public:
  // In the system's folder for such files (TMPDIR), empty, readable by this user alone; its name ends in `suffix`.
  [[nodiscard]] static Result<std::unique_ptr<TemporaryFile>> Make(const std::string& suffix);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

// Unpacks a zstd file into `to`, which is there and empty until it is done where the file system has files without a
// name: a program that is ended meanwhile leaves nothing behind. Trouble in the packed data is told to `told`, and what
// came out before it stays; an error is the disk's, or more than kPackedFileBytesMax.
[[nodiscard]] Status UnpackZstdFile(const std::filesystem::path& from, const std::filesystem::path& to,
                                    const std::function<void(Error)>& told);

}  // namespace rigcal::bags
