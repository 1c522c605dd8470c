// One payload on its way to disk: pieces in any order, sent once or more often, into one file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "server/base/digests/sha256.h"

namespace rigcal::dds {

struct ByteRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

// Which bytes of a payload have arrived.
class ByteRanges {
 public:
  // Covers `range`; the parts of it that were not covered before, ascending.
  std::vector<ByteRange> Add(ByteRange range);
  [[nodiscard]] bool CoversUpTo(std::uint64_t end) const;  // [0, end) without a gap
  [[nodiscard]] std::size_t pieces() const { return end_by_begin_.size(); }

 private:
  std::map<std::uint64_t, std::uint64_t> end_by_begin_;  // disjoint, not touching
};

// One thread at a time.
class PartFile {
 public:
  // The file need not be there: the first Flush makes it. `size_bytes`: of the whole payload.
  PartFile(std::filesystem::path path, std::uint64_t size_bytes) : path_(std::move(path)), size_bytes_(size_bytes) {}

  // Kept in memory until Flush. The caller has checked that the piece lies within the payload.
  void Add(std::uint64_t offset_bytes, std::string bytes);
  // Writes what was added and hashes what has no gap before it. Bytes that are there already are never written again:
  // what was hashed stays as it was. kStorage: nothing of this part can be trusted any more.
  [[nodiscard]] Status Flush();
  [[nodiscard]] bool Complete() const { return pieces_.empty() && ranges_.CoversUpTo(size_bytes_); }
  // sha256 of the complete file; once.
  [[nodiscard]] Result<Digest> Hash();
  // In so many bits and pieces that it is no honest transfer.
  [[nodiscard]] bool Shattered() const;

  // As they were given.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::uint64_t size_bytes() const { return size_bytes_; }

 private:
  struct Piece {
    std::uint64_t offset_bytes;
    std::string bytes;
  };
  [[nodiscard]] Status WritePiece(int fd, const Piece& piece);

  std::filesystem::path path_;
  std::uint64_t size_bytes_;
  std::vector<Piece> pieces_;
  ByteRanges ranges_;
  Sha256 hash_;
  std::uint64_t hashed_bytes_ = 0;
};

}  // namespace rigcal::dds
