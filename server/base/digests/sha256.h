// SHA-256 through OpenSSL; digests are 64 lower-case hex digits.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "server/base/ids.h"
#include "server/base/result.h"

namespace rigcal {

// Feed bytes, then Finish() once.
class Sha256 {
 public:
  // Aborts if OpenSSL has no SHA-256, as the next do if it fails.
  Sha256();
  ~Sha256();
  // That which was moved from may only be assigned to or destroyed.
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;
  // In as many pieces as one likes: the digest is that of all bytes in their order.
  void Add(std::span<const std::byte> bytes);
  void Add(std::string_view text);
  [[nodiscard]] Digest Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The digest of all bytes at once, 64 lower-case hex digits.
[[nodiscard]] Digest Sha256Of(std::string_view text);
[[nodiscard]] Digest Sha256Of(std::span<const std::byte> bytes);
// Reads the file in pieces of 1 MiB. The error names the file.
[[nodiscard]] Result<Digest> Sha256OfFile(const std::filesystem::path& path);

}  // namespace rigcal
