// The records of the format's own conformance files against the JSON that their authors published.
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/bags/cursor.h"
#include "client/bags/mcap/mcap_walk.h"
#include "tests/unit/recordings.h"

namespace rigcal::bags {
namespace {

using nlohmann::json;

template <typename T>
json Digits(T number) {
  return std::to_string(number);
}
json ByteList(Bytes bytes) {
  json list = json::array();
  for (const std::byte byte : bytes) list.push_back(std::to_string(std::to_integer<int>(byte)));
  return list;
}
json PairsOf(Cursor& in) {
  json pairs = json::object();
  for (Cursor inner(in.Block()); !inner.AtEnd();) {
    const std::string key(inner.Text());
    pairs[key] = std::string(inner.Text());
  }
  return pairs;
}
template <typename Key>
json NumbersOf(Cursor& in) {
  json pairs = json::object();
  for (Cursor inner(in.Block()); !inner.AtEnd();) {
    const auto key = std::to_string(inner.Number<Key>());
    pairs[key] = Digits(inner.Number<std::uint64_t>());
  }
  return pairs;
}

json FieldsOfData(McapOp op, Bytes content) {
  switch (op) {
    case McapOp::kHeader: {
      const auto header = ReadMcapHeader(content).value();
      return {{"library", header.library}, {"profile", header.profile}};
    }
    case McapOp::kSchema: {
      const auto schema = ReadMcapSchema(content).value();
      return {{"data", ByteList(schema.data)},
              {"encoding", schema.encoding},
              {"id", Digits(schema.id)},
              {"name", schema.name}};
    }
    case McapOp::kChannel: {
      const auto channel = ReadMcapChannel(content).value();
      return {{"id", Digits(channel.id)},
              {"message_encoding", channel.message_encoding},
              {"metadata", channel.metadata},
              {"schema_id", Digits(channel.schema_id)},
              {"topic", channel.topic}};
    }
    case McapOp::kMessage: {
      const auto message = ReadMcapMessage(content).value();
      return {{"channel_id", Digits(message.channel_id)},
              {"data", ByteList(message.data)},
              {"log_time", Digits(message.log_ns)},
              {"publish_time", Digits(message.publish_ns)},
              {"sequence", Digits(message.sequence)}};
    }
    case McapOp::kFooter: {
      const auto footer = ReadMcapFooter(content).value();
      return {{"summary_crc", Digits(footer.summary_crc)},
              {"summary_offset_start", Digits(footer.summary_offset_start)},
              {"summary_start", Digits(footer.summary_start)}};
    }
    default:
      return nullptr;
  }
}

// Of those that the reader itself has no use for: taken apart here, in the order of the format's page.
json FieldsOfIndex(McapOp op, Bytes content) {
  Cursor in(content);
  json fields = json::object();
  const auto u64 = [&](const char* name) { fields[name] = Digits(in.Number<std::uint64_t>()); };
  const auto text = [&](const char* name) { fields[name] = std::string(in.Text()); };
  if (op == McapOp::kDataEnd) fields["data_section_crc"] = Digits(in.Number<std::uint32_t>());
  if (op == McapOp::kMetadata) text("name"), fields["metadata"] = PairsOf(in);
  if (op == McapOp::kMetadataIndex) u64("offset"), u64("length"), text("name");
  if (op == McapOp::kAttachmentIndex)
    u64("offset"), u64("length"), u64("log_time"), u64("create_time"), u64("data_size"), text("name"),
        text("media_type");
  if (op == McapOp::kAttachment) {
    u64("log_time"), u64("create_time"), text("name"), text("media_type");
    fields["data"] = ByteList(in.Bytes(in.Number<std::uint64_t>()));
  }
  if (op == McapOp::kSummaryOffset) {
    fields["group_opcode"] = Digits(static_cast<int>(in.Number<std::uint8_t>()));
    u64("group_start"), u64("group_length");
  }
  if (op == McapOp::kChunkIndex) {
    u64("message_start_time"), u64("message_end_time"), u64("chunk_start_offset"), u64("chunk_length");
    fields["message_index_offsets"] = NumbersOf<std::uint16_t>(in);
    u64("message_index_length"), text("compression"), u64("compressed_size"), u64("uncompressed_size");
    EXPECT_EQ(Digits(ReadMcapChunkIndex(content)->offset), fields["chunk_start_offset"]);
  }
  if (op == McapOp::kStatistics) {
    u64("message_count");
    fields["schema_count"] = Digits(in.Number<std::uint16_t>());
    for (const char* name : {"channel_count", "attachment_count", "metadata_count", "chunk_count"})
      fields[name] = Digits(in.Number<std::uint32_t>());
    u64("message_start_time"), u64("message_end_time");
    fields["channel_message_counts"] = NumbersOf<std::uint16_t>(in);
    EXPECT_EQ(Digits(ReadMcapStatistics(content)->messages), fields["message_count"]);
  }
  return fields;
}

json RecordsOf(const std::filesystem::path& file) {
  json records = json::array();
  auto walk = McapWalk::Begin(OpenSource(file).value());
  while (const auto record = walk->Next()) {
    if (record->op == McapOp::kMessageIndex) continue;  // as the published JSON does
    json fields = FieldsOfData(record->op, record->content);
    if (fields.is_null()) fields = FieldsOfIndex(record->op, record->content);
    json list = json::array();
    for (const auto& [name, value] : fields.items()) list.push_back({name, value});
    records.push_back({{"type", NameOf(record->op)}, {"fields", list}});
  }
  EXPECT_TRUE(walk->damage().empty()) << file << ": " << walk->damage().All()[0].what;
  EXPECT_TRUE(walk->closed());
  return records;
}

TEST(McapConformance, EveryFileReadsAsItsJsonSays) {
  RIGCAL_SKIP_WITHOUT_RECORDING("bags/mcap_conformance");
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(Recording("bags/mcap_conformance"))) {
    if (entry.path().extension() != ".mcap") continue;
    std::ifstream text(std::filesystem::path(entry.path()).replace_extension(".json"));
    EXPECT_EQ(RecordsOf(entry.path()), json::parse(text)["records"]) << entry.path();
    ++count;
  }
  EXPECT_EQ(count, 171U);
}

}  // namespace
}  // namespace rigcal::bags
