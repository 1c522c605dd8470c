#include "client/bags/mcap/mcap_contents.h"

#include <algorithm>

namespace rigcal::bags {

void McapBytes::Text(std::string_view text) {
  Number(static_cast<std::uint32_t>(text.size()));
  Raw(BytesIn(text));
}

void McapBytes::Record(McapOp op, const McapBytes& content) {
  Number(op);
  Number<std::uint64_t>(content.size());
  Raw(content.bytes());
}

std::uint64_t McapContents::Messages() const {
  std::uint64_t sum = 0;
  for (const McapWrittenChannel& channel : channels) sum += channel.messages;
  return sum;
}

McapBytes SchemaContent(const McapContents& contents, std::uint16_t channel) {
  const Topic& topic = contents.channels[channel].topic;
  McapBytes content;
  content.Number(static_cast<std::uint16_t>(channel + 1));  // 0 stands for none
  content.Text(topic.type);
  content.Text(topic.schema_encoding);
  content.Text(topic.schema);
  return content;
}

McapBytes ChannelContent(const McapContents& contents, std::uint16_t channel) {
  const Topic& topic = contents.channels[channel].topic;
  McapBytes content;
  content.Number(channel);
  content.Number(static_cast<std::uint16_t>(channel + 1));
  content.Text(topic.name);
  content.Text(topic.encoding);
  content.Text("");  // no metadata
  return content;
}

namespace {

McapBytes StatisticsContent(const McapContents& contents) {
  McapBytes content, counts;
  std::uint64_t start_ns = contents.chunks.empty() ? 0 : UINT64_MAX, end_ns = 0;
  for (const McapWrittenChunk& chunk : contents.chunks) {
    start_ns = std::min(start_ns, chunk.start_ns);
    end_ns = std::max(end_ns, chunk.end_ns);
  }
  content.Number(contents.Messages());
  content.Number(static_cast<std::uint16_t>(contents.channels.size()));
  content.Number(static_cast<std::uint32_t>(contents.channels.size()));
  content.Number<std::uint32_t>(0);  // attachments
  content.Number<std::uint32_t>(0);  // metadata
  content.Number(static_cast<std::uint32_t>(contents.chunks.size()));
  content.Number(start_ns);
  content.Number(end_ns);
  for (std::uint16_t i = 0; i < contents.channels.size(); ++i) {
    counts.Number(i);
    counts.Number(contents.channels[i].messages);
  }
  content.Number(static_cast<std::uint32_t>(counts.size()));
  content.Raw(counts.bytes());
  return content;
}

McapBytes ChunkIndexContent(const McapWrittenChunk& chunk) {
  McapBytes content, offsets;
  for (const auto& [channel, offset] : chunk.index_offsets) {
    offsets.Number(channel);
    offsets.Number(offset);
  }
  content.Number(chunk.start_ns);
  content.Number(chunk.end_ns);
  content.Number(chunk.offset);
  content.Number(chunk.length);
  content.Number(static_cast<std::uint32_t>(offsets.size()));
  content.Raw(offsets.bytes());
  content.Number(chunk.index_length);
  content.Text("");
  content.Number(chunk.records_bytes);
  content.Number(chunk.records_bytes);
  return content;
}

// Of a group of records of one kind that ends the summary so far.
void NoteGroup(McapOp op, std::uint64_t start, std::uint64_t end, McapBytes& offsets) {
  if (start == end) return;
  McapBytes content;
  content.Number(op);
  content.Number(start);
  content.Number(end - start);
  offsets.Record(McapOp::kSummaryOffset, content);
}

}  // namespace

// From `at` in the file on: definitions, chunks, statistics, where these are, and the footer.
McapBytes SummaryRecords(const McapContents& contents, std::uint64_t at) {
  McapBytes out, offsets, footer;
  std::uint64_t start = at;
  const auto end_group = [&](McapOp op) {
    NoteGroup(op, start, at + out.size(), offsets);
    start = at + out.size();
  };
  for (std::uint16_t i = 0; i < contents.channels.size(); ++i) out.Record(McapOp::kSchema, SchemaContent(contents, i));
  end_group(McapOp::kSchema);
  for (std::uint16_t i = 0; i < contents.channels.size(); ++i)
    out.Record(McapOp::kChannel, ChannelContent(contents, i));
  end_group(McapOp::kChannel);
  out.Record(McapOp::kStatistics, StatisticsContent(contents));
  end_group(McapOp::kStatistics);
  for (const McapWrittenChunk& chunk : contents.chunks) out.Record(McapOp::kChunkIndex, ChunkIndexContent(chunk));
  end_group(McapOp::kChunkIndex);
  footer.Number(at);
  footer.Number(start);
  footer.Number<std::uint32_t>(0);  // no checksum
  out.Raw(offsets.bytes());
  out.Record(McapOp::kFooter, footer);
  out.Raw(BytesIn(kMcapMagic));
  return out;
}

}  // namespace rigcal::bags
