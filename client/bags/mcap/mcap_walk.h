// Goes through an MCAP file record by record, into its chunks, as far as the file goes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "client/bags/bag.h"
#include "client/bags/byte_source.h"
#include "client/bags/mcap/mcap_records.h"

namespace rigcal::bags {

struct McapRecord {
  McapOp op = McapOp::kHeader;
  Bytes content;             // until the next call
  std::uint64_t offset = 0;  // of the record, or of the chunk that it lies in
};

// Chunks are not given, what is in them is. Where a record or a chunk cannot be read, the walk goes on behind it, or at
// the next chunk that the file's own index names; what was lost is noted. Whether anything is lost that was never
// written cannot be seen.
class McapWalk {
 public:
  // Refuses what is no MCAP file, or of another version than 0.
  [[nodiscard]] static Result<McapWalk> Begin(std::unique_ptr<ByteSource> source);

  // The next record in the order of the file, DataEnd and what follows it included; nothing at the end.
  [[nodiscard]] std::optional<McapRecord> Next();
  [[nodiscard]] const Damage& damage() const { return damage_; }
  [[nodiscard]] Damage& damage() { return damage_; }
  [[nodiscard]] const ByteSource& source() const { return *source_; }
  [[nodiscard]] std::uint64_t offset() const { return at_; }
  // Whether the Footer came, which a recorder writes last.
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  explicit McapWalk(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}
  // The chunk whose records are being given.
  struct OpenChunk {
    std::uint64_t offset = 0, end = 0;  // of its record; `end` where its records lie in the file as they are
    std::uint64_t lost_before_end = 0;  // bytes of its records that the file does not have
    std::vector<std::byte> unpacked;    // else: its records
    std::size_t read = 0;               // of `unpacked`
    bool in_file = false;
    std::uint32_t crc = 0, crc_so_far = 0;
    std::optional<std::string> trouble;  // told when its records are through
  };

  [[nodiscard]] std::optional<McapRecord> NextOfFile();
  [[nodiscard]] std::optional<McapRecord> NextOfUnpacked();
  [[nodiscard]] bool EnterChunk(std::uint64_t content_at, std::uint64_t length);
  [[nodiscard]] bool UnpackChunk(const McapChunk& chunk, std::uint64_t records_at, std::uint64_t there);
  void LeaveChunk();
  [[nodiscard]] Result<Bytes> Read(std::uint64_t offset, std::uint64_t count);
  void Lose(std::uint64_t offset, const std::string& what);
  [[nodiscard]] bool SkipToIndexedChunk(std::uint64_t after);

  std::unique_ptr<ByteSource> source_;
  std::uint64_t at_ = 0;
  std::vector<std::byte> buffer_;
  std::optional<OpenChunk> chunk_;
  std::optional<std::vector<std::uint64_t>> indexed_;  // chunks, once they were asked for
  bool closed_ = false, over_ = false;
  Damage damage_;
};

// Where the summary at the end of the file says that chunks begin, in the order of the file; none where it has no
// summary.
[[nodiscard]] std::vector<std::uint64_t> IndexedChunks(ByteSource& source);
// The Statistics of that summary.
[[nodiscard]] std::optional<McapStatistics> SummaryStatistics(ByteSource& source);

}  // namespace rigcal::bags
