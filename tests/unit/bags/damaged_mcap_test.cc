// A small MCAP file, built here, then damaged at each of its bytes.
#include <gtest/gtest.h>
#include <zstd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "client/bags/mcap/mcap_bag.h"
#include "client/bags/open_bag.h"
#include "client/bags/ros1_bag.h"
#include "tests/unit/temp_folder.h"

namespace rigcal::bags {
namespace {

std::string Little(std::uint64_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
  return bytes;
}
std::string Block(const std::string& bytes) { return Little(bytes.size(), 4) + bytes; }
std::string Record(int op, const std::string& content) {
  return Little(static_cast<std::uint64_t>(op), 1) + Little(content.size(), 8) + content;
}
std::string MessageOf(int k) {
  return Record(
      5, Little(1, 2) + Little(0, 4) + Little(static_cast<std::uint64_t>(k), 8) + Little(7, 8) + std::string(40, 'm'));
}

// Two chunks of two messages each, and an index of the chunks.
std::string File() {
  const std::string magic("\x89MCAP0\r\n", 8);
  const std::string head =
      Record(3, Little(1, 2) + Block("std_msgs/msg/String") + Block("ros2msg") + Block("string data\n")) +
      Record(4, Little(1, 2) + Little(1, 2) + Block("/t") + Block("cdr") + Block(""));
  std::string file = magic + Record(1, Block("ros2") + Block("test")), index;
  for (int chunk = 0; chunk < 2; ++chunk) {
    const std::string records = head + MessageOf(2 * chunk) + MessageOf(2 * chunk + 1);
    const std::size_t offset = file.size();
    file += Record(6, Little(0, 8) + Little(9, 8) + Little(records.size(), 8) + Little(0, 4) + Block("") +
                          Little(records.size(), 8) + records);
    index += Record(8, Little(0, 8) + Little(9, 8) + Little(offset, 8) + Little(file.size() - offset, 8) + Block("") +
                           Little(0, 8) + Block("") + Little(0, 8) + Little(0, 8));
  }
  file += Record(15, Little(0, 4));
  const std::size_t summary = file.size();
  return file + index + Record(2, Little(summary, 8) + Little(0, 8) + Little(0, 4)) + magic;
}

struct Told {
  std::set<std::int64_t> times;
  std::size_t sentences = 0;
};
Told Read(const std::string& file) {
  auto bag = OpenMcap(SourceOf(std::as_bytes(std::span(file)), "file"));
  if (!bag) return {{}, 1};
  Told told;
  for (Message message; (*bag)->Next(message);) told.times.insert(message.log_ns);
  told.sentences = (*bag)->Unread().All().size();
  return told;
}

TEST(DamagedMcap, AWholeOneIsReadWithoutAWord) {
  const Told told = Read(File());
  EXPECT_EQ(told.times, (std::set<std::int64_t>{0, 1, 2, 3}));
  EXPECT_EQ(told.sentences, 0U);
}

TEST(DamagedMcap, CutAnywhereItIsOneSentenceAndWhatWasBefore) {
  const std::string file = File();
  const std::size_t end = file.size() - 8 - 29 - 2 * (9 + 64) - 13;  // where its data ends
  std::size_t most = 0;
  for (std::size_t size = 0; size < end; ++size) {
    const Told told = Read(file.substr(0, size));
    EXPECT_EQ(told.sentences, 1U) << size;
    EXPECT_GE(told.times.size(), most) << size;
    most = told.times.size();
  }
  EXPECT_EQ(most, 3U);  // the last of four needs its last byte
}

TEST(DamagedMcap, ALengthThatIsWrongLosesItsChunkAlone) {
  const std::string file = File();
  const std::size_t first_message = file.find(MessageOf(0));
  std::string damaged = file;
  damaged[first_message + 7] = 0x7F;  // of the length
  const Told told = Read(damaged);
  EXPECT_EQ(told.times, (std::set<std::int64_t>{2, 3}));
  EXPECT_EQ(told.sentences, 1U);
}

TEST(DamagedMcap, EveryByteMayBeAnyOther) {
  const std::string file = File();
  for (std::size_t at = 0; at < file.size(); ++at)
    for (const int value : {0, 0xFF, 0x80}) {
      std::string damaged = file;
      damaged[at] = static_cast<char>(value);
      (void)Read(damaged);  // neither aborts nor hangs
    }
}

// It is unpacked into a file that has no name while it is read; what is wrong is told of the bag that was given.
TEST(DamagedMcap, APackedBagLeavesNothingBehindAndIsCalledByItsName) {
  namespace fs = std::filesystem;
  const TempFolder place;
  const fs::path& folder = place.path();
  const fs::path bag = folder / "drive.mcap.zstd";
  const std::string file = File().substr(0, File().size() - 20);  // cut off
  std::string packed(ZSTD_compressBound(file.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), file.data(), file.size(), 1));
  std::ofstream(bag, std::ios::binary) << packed;
  setenv("TMPDIR", folder.c_str(), 1);
  auto opened = OpenBag(bag);
  unsetenv("TMPDIR");
  ASSERT_TRUE(opened) << opened.error().what;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1) << "the bag alone";
  int messages = 0;
  for (Message message; (*opened)->Next(message);) ++messages;
  EXPECT_EQ(messages, 4);
  const std::vector<Error> told = (*opened)->Unread().All();
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told.front().what.rfind(bag.string(), 0), 0U) << told.front().what;
}

TEST(DamagedMcap, OtherFilesAreRefused) {
  EXPECT_EQ(Read("").sentences, 1U);
  EXPECT_EQ(Read("hello").sentences, 1U);
  EXPECT_EQ(Read("\x89MCAP1\r\n").sentences, 1U);
  const std::string old = "#ROSBAG V1.2\n";
  EXPECT_FALSE(OpenRos1Bag(SourceOf(std::as_bytes(std::span(old)), "old")));
}

}  // namespace
}  // namespace rigcal::bags
