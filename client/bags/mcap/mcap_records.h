// The records of an MCAP file as values (format: mcap.dev/spec, version 0). Each reader takes a record's content,
// without its opcode and length, and gives nothing where the content is shorter than its own fields say.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rigcal::bags {

enum class McapOp : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};
// "Chunk", ...; "record of kind 200" for one that this version does not know.
[[nodiscard]] std::string NameOf(McapOp op);

using Bytes = std::span<const std::byte>;  // all of these point into the content

struct McapHeader {
  std::string_view profile, library;
};
struct McapSchema {
  std::uint16_t id = 0;  // never 0
  std::string_view name, encoding;
  Bytes data;
};
struct McapChannel {
  std::uint16_t id = 0, schema_id = 0;  // schema 0: none
  std::string_view topic, message_encoding;
  std::map<std::string, std::string> metadata;
};
struct McapMessage {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_ns = 0, publish_ns = 0;
  Bytes data;
};
// Up to its records, which follow.
struct McapChunk {
  std::uint64_t start_ns = 0, end_ns = 0, unpacked_bytes = 0;
  std::uint32_t crc = 0;  // of the unpacked records; 0: not known
  std::string_view packing;
  std::uint64_t packed_bytes = 0;
  std::size_t head_bytes = 0;  // of the content before its records
};
struct McapChunkIndex {
  std::uint64_t start_ns = 0, end_ns = 0, offset = 0, length = 0;  // of the chunk's record in the file
};
struct McapStatistics {
  std::uint64_t messages = 0;
};
struct McapFooter {
  std::uint64_t summary_start = 0, summary_offset_start = 0;  // 0: there is none
  std::uint32_t summary_crc = 0;
};

// A record from its content; nothing where that is too short or a length in it goes beyond its end.
[[nodiscard]] std::optional<McapHeader> ReadMcapHeader(Bytes content);
[[nodiscard]] std::optional<McapSchema> ReadMcapSchema(Bytes content);
[[nodiscard]] std::optional<McapChannel> ReadMcapChannel(Bytes content);
[[nodiscard]] std::optional<McapMessage> ReadMcapMessage(Bytes content);
// Of the first bytes of the content, at most kChunkHeadBytesMax of which are needed.
inline constexpr std::size_t kChunkHeadBytesMax = 8 * 3 + 4 + 4 + 64 + 8;
[[nodiscard]] std::optional<McapChunk> ReadMcapChunk(Bytes content);
[[nodiscard]] std::optional<McapChunkIndex> ReadMcapChunkIndex(Bytes content);
[[nodiscard]] std::optional<McapStatistics> ReadMcapStatistics(Bytes content);
[[nodiscard]] std::optional<McapFooter> ReadMcapFooter(Bytes content);

}  // namespace rigcal::bags
