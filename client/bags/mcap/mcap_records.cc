#include "client/bags/mcap/mcap_records.h"

#include <array>

#include "client/bags/cursor.h"

namespace rigcal::bags {
namespace {

// What was read, if all of it was there.
template <typename Record>
std::optional<Record> Whole(const Cursor& cursor, Record record) {
  if (cursor.failed()) return std::nullopt;
  return record;
}

}  // namespace

std::string NameOf(McapOp op) {
  constexpr std::array kNames = {"Header",     "Footer",       "Schema",        "Channel",       "Message",
                                 "Chunk",      "MessageIndex", "ChunkIndex",    "Attachment",    "AttachmentIndex",
                                 "Statistics", "Metadata",     "MetadataIndex", "SummaryOffset", "DataEnd"};
  const std::size_t number = static_cast<std::size_t>(op);
  if (number == 0 || number > kNames.size()) return "record of kind " + std::to_string(number);
  return kNames[number - 1];
}

std::optional<McapHeader> ReadMcapHeader(Bytes content) {
  Cursor in(content);
  McapHeader header;
  header.profile = in.Text();
  header.library = in.Text();
  return Whole(in, header);
}

std::optional<McapSchema> ReadMcapSchema(Bytes content) {
  Cursor in(content);
  McapSchema schema;
  schema.id = in.Number<std::uint16_t>();
  schema.name = in.Text();
  schema.encoding = in.Text();
  schema.data = in.Block();
  if (schema.id == 0) return std::nullopt;
  return Whole(in, schema);
}

std::optional<McapChannel> ReadMcapChannel(Bytes content) {
  Cursor in(content);
  McapChannel channel;
  channel.id = in.Number<std::uint16_t>();
  channel.schema_id = in.Number<std::uint16_t>();
  channel.topic = in.Text();
  channel.message_encoding = in.Text();
  Cursor pairs(in.Block());
  while (!pairs.AtEnd()) {
    const std::string key(pairs.Text());
    channel.metadata[key] = pairs.Text();
  }
  if (pairs.failed()) return std::nullopt;
  return Whole(in, channel);
}

std::optional<McapMessage> ReadMcapMessage(Bytes content) {
  Cursor in(content);
  McapMessage message;
  message.channel_id = in.Number<std::uint16_t>();
  message.sequence = in.Number<std::uint32_t>();
  message.log_ns = in.Number<std::uint64_t>();
  message.publish_ns = in.Number<std::uint64_t>();
  message.data = in.rest();
  return Whole(in, message);
}

std::optional<McapChunk> ReadMcapChunk(Bytes content) {
  Cursor in(content);
  McapChunk chunk;
  chunk.start_ns = in.Number<std::uint64_t>();
  chunk.end_ns = in.Number<std::uint64_t>();
  chunk.unpacked_bytes = in.Number<std::uint64_t>();
  chunk.crc = in.Number<std::uint32_t>();
  chunk.packing = in.Text();
  chunk.packed_bytes = in.Number<std::uint64_t>();
  chunk.head_bytes = content.size() - in.rest().size();
  return Whole(in, chunk);
}

std::optional<McapChunkIndex> ReadMcapChunkIndex(Bytes content) {
  Cursor in(content);
  McapChunkIndex index;
  index.start_ns = in.Number<std::uint64_t>();
  index.end_ns = in.Number<std::uint64_t>();
  index.offset = in.Number<std::uint64_t>();
  index.length = in.Number<std::uint64_t>();
  return Whole(in, index);
}

std::optional<McapStatistics> ReadMcapStatistics(Bytes content) {
  Cursor in(content);
  McapStatistics statistics;
  statistics.messages = in.Number<std::uint64_t>();
  return Whole(in, statistics);
}

std::optional<McapFooter> ReadMcapFooter(Bytes content) {
  Cursor in(content);
  McapFooter footer;
  footer.summary_start = in.Number<std::uint64_t>();
  footer.summary_offset_start = in.Number<std::uint64_t>();
  footer.summary_crc = in.Number<std::uint32_t>();
  return Whole(in, footer);
}

}  // namespace rigcal::bags
