// Where a bag's bytes lie: a file, or memory. Read from any place, in pieces.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "server/base/result.h"

namespace rigcal::bags {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Fills `to` with the bytes from `offset` on; fewer at the end. The error is the disk's and names the file.
  [[nodiscard]] virtual Result<std::size_t> ReadAt(std::uint64_t offset, std::span<std::byte> to) = 0;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  [[nodiscard]] virtual const std::string& name() const = 0;  // starts every error
};

// A regular file; kNotFound or kInvalidInput where there is none.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> OpenSource(const std::filesystem::path& path);
// The same, of what goes by another name.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> OpenSource(const std::filesystem::path& path, std::string name);
// Memory that outlives it.
[[nodiscard]] std::unique_ptr<ByteSource> SourceOf(std::span<const std::byte> bytes, std::string name);

}  // namespace rigcal::bags
