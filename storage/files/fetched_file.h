// A content that comes in pieces from a bucket: beside its place until it is whole. For storage/*.cc only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "server/base/digests/sha256.h"
#include "server/base/files/file_descriptor.h"

namespace rigcal::storage {

class FetchedFile {
 public:
  explicit FetchedFile(std::filesystem::path target);
  ~FetchedFile();  // what was not kept is gone
  FetchedFile(const FetchedFile&) = delete;
  FetchedFile& operator=(const FetchedFile&) = delete;

  // The next bytes, from `at`; at 0 it begins anew. kStorage.
  [[nodiscard]] Status Take(std::int64_t at, std::string_view bytes);
  // Of all bytes that were taken. Once.
  [[nodiscard]] Digest Hash();
  // Moves it to its place, durably.
  [[nodiscard]] Status Keep();

 private:
  [[nodiscard]] Status Begin();

  const std::filesystem::path target_, temporary_;
  FileDescriptor file_{-1};
  Sha256 hash_;
  bool is_kept_ = false;
};

}  // namespace rigcal::storage
