// What is written is read again, whole and cut off at any place, and by the file's own index.
#include "client/bags/mcap/mcap_writer.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>

#include "client/bags/cursor.h"
#include "client/bags/open_bag.h"
#include "tests/unit/bags/bag_place.h"

namespace rigcal::bags {
namespace {

namespace fs = std::filesystem;

std::string WholeFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Topic TopicOf(const std::string& name) { return {name, "std_msgs/msg/String", "cdr", "ros2msg", "string data\n"}; }

std::vector<std::byte> Payload(int k, std::size_t size) {
  return std::vector<std::byte>(size, static_cast<std::byte>(k));
}

// Three chunks: 2, 2 and 1 messages of two topics in turn.
void WriteFive(const fs::path& path) {
  auto writer = McapWriter::Create(path).value();
  const std::uint16_t a = writer.Add(TopicOf("/a")).value(), b = writer.Add(TopicOf("/b")).value();
  EXPECT_EQ(writer.Add(TopicOf("/a")).value(), a);
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(writer.Write(k % 2 == 0 ? a : b, 100 + k, 10 + k, Payload(k, 1000)));
    if (k % 2 == 1) {
      ASSERT_TRUE(writer.Flush());
    }
  }
  EXPECT_EQ(writer.messages(), 4U);
  EXPECT_EQ(writer.waiting_messages(), 1U);
  ASSERT_TRUE(writer.Close());
  EXPECT_EQ(writer.messages(), 5U);
  EXPECT_EQ(writer.bytes(), fs::file_size(path));
}

struct ReadBack {
  std::vector<std::int64_t> log_ns;
  std::vector<Error> damage;
};
ReadBack ReadFileAgain(const fs::path& path) {
  const auto bag = OpenBag(path);
  if (!bag) return {{}, {bag.error()}};
  ReadBack read;
  for (Message message; (*bag)->Next(message);) {
    const int k = static_cast<int>(message.log_ns) - 100;
    EXPECT_EQ(message.publish_ns, 10 + k);
    EXPECT_EQ(message.topic->name, k % 2 == 0 ? "/a" : "/b");
    EXPECT_EQ(message.topic->type, "std_msgs/msg/String");
    EXPECT_EQ(message.topic->encoding, "cdr");
    EXPECT_EQ(message.topic->schema, "string data\n");
    EXPECT_EQ((std::vector<std::byte>(message.bytes.begin(), message.bytes.end())), Payload(k, 1000));
    read.log_ns.push_back(message.log_ns);
  }
  read.damage = (*bag)->Unread().All();
  return read;
}

TEST(McapWriter, WhatIsWrittenIsReadWithoutAWord) {
  const BagPlace place;
  WriteFive(place.file());
  const ReadBack read = ReadFileAgain(place.file());
  EXPECT_THAT(read.log_ns, testing::ElementsAre(100, 101, 102, 103, 104));
  EXPECT_TRUE(read.damage.empty()) << Sentence(read.damage.front());
}

// A chunk that is whole is given, and of one that was cut what is there; each time with a sentence.
TEST(McapWriter, CutOffAnywhereItIsABagAsFarAsItGoes) {
  const BagPlace place;
  WriteFive(place.file());
  const std::string whole = WholeFile(place.file());
  std::size_t most = 0;
  for (std::size_t size = 60; size < whole.size(); size += 37) {
    std::ofstream(place.file(), std::ios::binary | std::ios::trunc) << whole.substr(0, size);
    const ReadBack read = ReadFileAgain(place.file());
    EXPECT_EQ(read.damage.size(), 1U) << size;
    EXPECT_GE(read.log_ns.size(), most) << size;
    most = std::max(most, read.log_ns.size());
  }
  EXPECT_EQ(most, 5U);
}

// A record's content, where one of that kind begins at `at`.
Bytes ContentAt(Bytes file, std::uint64_t at, McapOp wanted) {
  Cursor record(file.subspan(at));
  EXPECT_EQ(record.Number<std::uint8_t>(), static_cast<std::uint8_t>(wanted)) << at;
  return record.Bytes(record.Number<std::uint64_t>());
}

// Of a chunk in the summary: how many messages its indexes lead to, each at its place with its time.
std::size_t MessagesOfChunk(Bytes file, Bytes entry) {
  Cursor in(entry);
  (void)in.Bytes(16);  // times
  const auto offset = in.Number<std::uint64_t>();
  (void)in.Number<std::uint64_t>();
  const Bytes chunk = ContentAt(file, offset, McapOp::kChunk);
  const Bytes records = chunk.subspan(ReadMcapChunk(chunk).value().head_bytes);
  std::size_t messages = 0;
  for (Cursor offsets(in.Block()); !offsets.AtEnd();) {
    const auto channel = offsets.Number<std::uint16_t>();
    Cursor index(ContentAt(file, offsets.Number<std::uint64_t>(), McapOp::kMessageIndex));
    EXPECT_EQ(index.Number<std::uint16_t>(), channel);
    for (Cursor rows(index.Block()); !rows.AtEnd(); ++messages) {
      const auto log_ns = rows.Number<std::uint64_t>();
      const auto message = ReadMcapMessage(ContentAt(records, rows.Number<std::uint64_t>(), McapOp::kMessage)).value();
      EXPECT_EQ(message.channel_id, channel);
      EXPECT_EQ(message.log_ns, log_ns);
    }
  }
  return messages;
}

TEST(McapWriter, TheIndexLeadsToEveryMessage) {
  const BagPlace place;
  WriteFive(place.file());
  const std::string text = WholeFile(place.file());
  const Bytes file = std::as_bytes(std::span(text));
  constexpr std::size_t kFooter_bytes = 1 + 8 + 20, kMagic_bytes = 8;
  const auto footer =
      ReadMcapFooter(ContentAt(file, file.size() - kMagic_bytes - kFooter_bytes, McapOp::kFooter)).value();
  std::map<McapOp, int> kinds, groups;
  std::size_t messages = 0;
  for (Cursor summary(file.subspan(footer.summary_start)); !summary.AtEnd();) {
    const auto op = static_cast<McapOp>(summary.Number<std::uint8_t>());
    const Bytes content = summary.Bytes(summary.Number<std::uint64_t>());
    ++kinds[op];
    if (op == McapOp::kChunkIndex) messages += MessagesOfChunk(file, content);
    if (op == McapOp::kStatistics) {
      EXPECT_EQ(ReadMcapStatistics(content).value().messages, 5U);
    }
    if (op == McapOp::kFooter) break;
    if (op != McapOp::kSummaryOffset) continue;
    Cursor group(content);
    const auto of = static_cast<McapOp>(group.Number<std::uint8_t>());
    (void)ContentAt(file, group.Number<std::uint64_t>(), of);
    ++groups[of];
  }
  EXPECT_EQ(messages, 5U);
  EXPECT_EQ(kinds[McapOp::kChunkIndex], 3);
  EXPECT_EQ(kinds[McapOp::kSchema], 2);
  EXPECT_EQ(kinds[McapOp::kChannel], 2);
  EXPECT_EQ(groups.size(), 4U) << "schemas, channels, statistics, chunks";
}

TEST(McapWriter, AFileThatIsThereIsKept) {
  const BagPlace place;
  std::ofstream(place.file()) << "a letter";
  const auto writer = McapWriter::Create(place.file());
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, ErrorCode::kConflict);
  EXPECT_EQ(WholeFile(place.file()), "a letter");
}

TEST(McapWriter, WhereTheDiskIsFullWholeChunksStay) {
  const BagPlace place;
  auto writer = McapWriter::Create(place.file()).value();
  const std::uint16_t a = writer.Add(TopicOf("/a")).value();
  std::optional<FullDisk> full(std::in_place, 5000);
  Status written;
  for (int k = 0; k < 9 && written; k += 2) {
    ASSERT_TRUE(writer.Write(a, 100 + k, 10 + k, Payload(k, 1000)));
    written = writer.Flush();
  }
  const Status again = writer.Flush(), closed = writer.Close();
  full.reset();
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kStorage);
  EXPECT_THAT(written.error().what, testing::HasSubstr(place.file().string()));
  EXPECT_FALSE(again);
  EXPECT_FALSE(closed);
  const ReadBack read = ReadFileAgain(place.file());
  EXPECT_EQ(read.log_ns.size(), writer.messages());
  EXPECT_GE(read.log_ns.size(), 2U);
  EXPECT_EQ(writer.waiting_messages(), 1U);
  EXPECT_EQ(read.damage.size(), 1U) << "it was not closed, and nothing else is amiss";
}

}  // namespace
}  // namespace rigcal::bags
