// Writes an MCAP file (format: mcap.dev/spec, version 0): chunks without compression, each with the definitions that
// its messages need and an index, so that what is left of a file that was cut off can be read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/bags/mcap/mcap_contents.h"
#include "server/base/files/file_descriptor.h"

namespace rigcal::bags {

// One thread. Where the disk fails, the file ends behind its last whole chunk, and every later call fails as the first
// did (kStorage).
class McapWriter {
 public:
  // kConflict: there is a file of that name.
  [[nodiscard]] static Result<McapWriter> Create(const std::filesystem::path& path);
  // The channel's number; the same for a topic of the same name and type. kBusy: there are too many.
  [[nodiscard]] Result<std::uint16_t> Add(const Topic& topic);
  // Goes to the file with its chunk: when that is large enough, or at Flush.
  [[nodiscard]] Status Write(std::uint16_t channel, std::int64_t log_ns, std::int64_t publish_ns, Bytes message);
  // What waits becomes a chunk of the file; nothing waits: nothing.
  [[nodiscard]] Status Flush();
  // Flush, then the summary and the end mark; durable when it returns.
  [[nodiscard]] Status Close();
  [[nodiscard]] std::uint64_t messages() const { return contents_.Messages(); }  // in the file
  [[nodiscard]] std::uint64_t waiting_messages() const { return chunk_.messages; }
  [[nodiscard]] std::uint64_t bytes() const { return written_bytes_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  struct Indexed {
    std::uint64_t log_ns, offset;
  };
  struct OpenChunk {
    McapBytes records;
    std::uint64_t start_ns = 0, end_ns = 0, messages = 0;
    std::map<std::uint16_t, std::vector<Indexed>> index;  // by channel
  };
  McapWriter(std::filesystem::path path, FileDescriptor file) : path_(std::move(path)), file_(std::move(file)) {}
  [[nodiscard]] Status Append(const McapBytes& bytes);
  [[nodiscard]] McapWrittenChunk IndexChunk(McapBytes& out) const;

  std::filesystem::path path_;
  FileDescriptor file_;
  std::optional<Error> failed_ = {};
  std::uint64_t written_bytes_ = 0;
  McapContents contents_;
  OpenChunk chunk_;
};

}  // namespace rigcal::bags
