// The files of a session, read in pieces; a file that changed since it was hashed is noticed and named.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/wire/push_engine.h"
#include "server/base/files/file_descriptor.h"
#include "server/model/sessions/session.h"

namespace rigcal::client {

struct FileMark {
  std::int64_t size_bytes = 0, modified_ns = 0;
  std::uint64_t inode = 0;
  friend bool operator==(const FileMark&, const FileMark&) = default;
};
// By path relative to the folder. Mark before hashing: then a change during or after it shows.
using FileMarks = std::map<std::string, FileMark>;
// Of all files below `folder`; what cannot be read is left out.
[[nodiscard]] FileMarks MarkFiles(const std::filesystem::path& folder);

class FilePieces {
 public:
  // `payloads` of the files in `folder`, in the manifest's order; `marks` as of MarkFiles.
  FilePieces(std::filesystem::path folder, std::vector<Payload> payloads, FileMarks marks);
  // Valid until the next call. One file is open at a time.
  [[nodiscard]] Result<const std::string*> Read(const ChunkAt& chunk);
  // The first file that is not as it was.
  [[nodiscard]] Status CheckAll() const;

 private:
  [[nodiscard]] Status Check(std::uint32_t payload_idx) const;
  [[nodiscard]] Error Changed(std::uint32_t payload_idx) const;

  std::filesystem::path folder_;
  std::vector<Payload> payloads_;
  FileMarks marks_;
  std::optional<FileDescriptor> file_;
  std::uint32_t open_idx_ = 0;
  std::string piece_;
};

}  // namespace rigcal::client
