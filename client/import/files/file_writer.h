// Writes the files of chosen messages; pictures are encoded several at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/bags/messages/value.h"
#include "client/import/files.h"
#include "client/import/files/session_folder.h"

namespace rigcal::importing {

// One thread at a time. Holds pictures of kWaitingBytesMax at most.
class FileWriter {
 public:
  // `folder` outlives it.
  explicit FileWriter(const SessionFolder& folder) : folder_(folder) {}

  // What became of one message.
  struct Fate {
    bool written = false;  // or there already, or waiting to be
    std::string refusal;   // else: why not
  };
  // "<stem>.png", ".jpg" or ".pcd", as the message is. The error is the disk's.
  [[nodiscard]] Result<Fate> Take(const std::string& stem, const std::string& type, const bags::Value& message);
  // Writes what waits.
  [[nodiscard]] Status Flush();
  [[nodiscard]] std::int64_t kept() const { return kept_; }  // files that were there already

 private:
  struct Waiting {
    std::string file;
    Pixels pixels;
  };
  [[nodiscard]] Status WriteUnlessThere(const std::string& file, const std::string& bytes);

  const SessionFolder& folder_;
  std::vector<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::int64_t kept_ = 0;
};

constexpr std::size_t kWaitingBytesMax = 48 << 20;

}  // namespace rigcal::importing
