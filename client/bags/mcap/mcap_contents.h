// What an MCAP file holds, as records that are written: definitions, and the summary at its end (format: mcap.dev/spec,
// version 0).
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "client/bags/bag.h"
#include "client/bags/mcap/mcap_records.h"

namespace rigcal::bags {

// Bytes of records, least byte first.
class McapBytes {
 public:
  // As it stands in memory.
  template <typename T>
  void Number(T value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
  }
  // With its 32-bit length before it.
  void Text(std::string_view text);
  // As they stand.
  void Raw(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  // A whole record.
  void Record(McapOp op, const McapBytes& content);
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  [[nodiscard]] Bytes bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

struct McapWrittenChannel {
  Topic topic;
  std::uint64_t messages = 0;
};
struct McapWrittenChunk {
  std::uint64_t start_ns = 0, end_ns = 0;
  std::uint64_t offset = 0, length = 0;  // of its record in the file
  std::uint64_t index_length = 0;        // of the records behind it that index its messages
  std::uint64_t records_bytes = 0;
  std::map<std::uint16_t, std::uint64_t> index_offsets;  // by channel, in the file
};

struct McapContents {
  std::vector<McapWrittenChannel> channels;  // the number of a channel is its place
  std::vector<McapWrittenChunk> chunks;
  // Of all channels.
  [[nodiscard]] std::uint64_t Messages() const;
};

// What is between a Schema's, and a Channel's, opcode and length and the next record. Each channel has a Schema of its
// own.
[[nodiscard]] McapBytes SchemaContent(const McapContents& contents, std::uint16_t channel);
[[nodiscard]] McapBytes ChannelContent(const McapContents& contents, std::uint16_t channel);
// What follows DataEnd, up to the end of the file; it begins at `at` in the file.
[[nodiscard]] McapBytes SummaryRecords(const McapContents& contents, std::uint64_t at);

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
// The same bytes.
[[nodiscard]] inline Bytes BytesIn(std::string_view text) {
  return {reinterpret_cast<const std::byte*>(text.data()), text.size()};
}

}  // namespace rigcal::bags
