#include "client/record/bag_file.h"

#include <gmock/gmock.h>

#include <optional>

#include "client/bags/open_bag.h"
#include "tests/unit/bags/bag_place.h"

namespace rigcal::recording {
namespace {

ReceivedMessage MessageAt(std::uint16_t channel, std::int64_t log_ns, std::size_t size = 100) {
  return {channel, log_ns, log_ns - 5, std::vector<std::byte>(size, std::byte{1})};
}

std::size_t MessagesIn(const std::filesystem::path& path) {
  const auto bag = bags::OpenBag(path).value();
  std::size_t count = 0;
  for (bags::Message message; bag->Next(message);) ++count;
  return count;
}

const bags::Topic kTopic{"/a", "std_msgs/msg/String", "cdr", "ros2msg", "string data\n"};

TEST(BagFile, WhatIsPutInIsInTheBag) {
  const bags::BagPlace place;
  const auto path = place.file();
  const auto bag = BagFile::Begin(path).value();
  const std::uint16_t channel = bag->Add(kTopic).value();
  for (int k = 0; k < 1000; ++k) ASSERT_TRUE(bag->Put(MessageAt(channel, 1 + k)));
  const BagTotals totals = bag->End();
  EXPECT_FALSE(bag->Trouble());
  EXPECT_EQ(totals.messages, 1000U);
  EXPECT_EQ(totals.unwritten, 0U);
  EXPECT_EQ(totals.bytes, std::filesystem::file_size(path));
  EXPECT_EQ(MessagesIn(path), 1000U);
}

TEST(BagFile, AnotherRecordingIsNotOverwritten) {
  const bags::BagPlace place;
  const auto path = place.file();
  ASSERT_EQ(BagFile::Begin(path).value()->End().messages, 0U);
  const auto again = BagFile::Begin(path);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::kConflict);
}

// What is in the bag and what is not is all that was put in.
TEST(BagFile, OnAFullDiskEveryMessageIsCounted) {
  const bags::BagPlace place;
  const auto path = place.file();
  std::optional<bags::FullDisk> full(std::in_place, 20 << 20);
  const auto bag = BagFile::Begin(path).value();
  const std::uint16_t channel = bag->Add(kTopic).value();
  std::uint64_t put = 0;
  for (int k = 0; k < 60; ++k)
    if (bag->Put(MessageAt(channel, 1 + k, 1 << 20))) ++put;
  const BagTotals totals = bag->End();
  full.reset();
  ASSERT_TRUE(bag->Trouble());
  EXPECT_EQ(bag->Trouble()->code, ErrorCode::kStorage);
  EXPECT_FALSE(bag->Put(MessageAt(channel, 1)));
  EXPECT_GT(totals.messages, 0U);
  EXPECT_GT(totals.unwritten, 0U);
  EXPECT_EQ(totals.messages + totals.unwritten, put);
  EXPECT_EQ(MessagesIn(path), totals.messages);
}

}  // namespace
}  // namespace rigcal::recording
