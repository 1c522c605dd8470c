#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "server/base/limits.h"
#include "server/dds/intake/arrival.h"

namespace rigcal::dds {
namespace {

using ::testing::HasSubstr;

wire::SampleOrigin OriginOf(const std::string& partition) { return {1, {partition}, 2}; }

rigcal_wire_Chunk ChunkOf(std::vector<std::uint8_t>& bytes) {
  rigcal_wire_Chunk sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  std::memset(sample.session_id, 'a', 64);
  sample.payload_idx = 3;
  sample.offset_bytes = 4;
  const auto count = static_cast<std::uint32_t>(bytes.size());
  sample.bytes = {count, count, bytes.data(), false};
  return sample;
}

TEST(FromIdl, GivesTheChunk) {
  std::vector<std::uint8_t> bytes = {1, 2, 3};
  const auto arrival = FromIdl(ChunkOf(bytes), OriginOf("robot/mapper-01"));
  ASSERT_TRUE(arrival);
  const auto& chunk = std::get<ChunkBytes>(*arrival);
  EXPECT_EQ(chunk.robot.str(), "mapper-01");
  EXPECT_EQ(chunk.session.str(), std::string(64, 'a'));
  EXPECT_EQ(chunk.payload_idx, 3u);
  EXPECT_EQ(chunk.offset_bytes, 4u);
  EXPECT_EQ(chunk.bytes, "\1\2\3");
}

TEST(FromIdl, AStrangerIsRefusedInItsOwnPartition) {
  std::vector<std::uint8_t> bytes = {1};
  const auto arrival = FromIdl(ChunkOf(bytes), OriginOf("robot/stranger"));
  ASSERT_TRUE(arrival);
  const auto& refusal = std::get<Refusal>(*arrival);
  EXPECT_EQ(refusal.partition.str(), "stranger");
  EXPECT_EQ(refusal.robot.str(), "mapper-01");
  EXPECT_THAT(refusal.error.what, HasSubstr("mapper-01"));
  EXPECT_THAT(refusal.error.what, HasSubstr("robot/stranger"));
  const auto terminal = FromIdl(ChunkOf(bytes), wire::SampleOrigin{1, {"\x1b[2J", "robot/stranger"}, 2});
  ASSERT_TRUE(terminal);
  EXPECT_THAT(std::get<Refusal>(*terminal).error.what, HasSubstr(R"("\x1b[2J")"));
}

TEST(FromIdl, GivesWhatARobotRunsInItsOwnPartitionOnly) {
  rigcal_wire_CalibrationInUse sample{};
  std::strcpy(sample.robot_id, "mapper-01");
  std::memset(sample.digest, 'd', 64);
  std::strcpy(sample.who, "agent");
  sample.applied_ns = 7;
  const auto arrival = FromIdl(sample, OriginOf("robot/mapper-01"));
  ASSERT_TRUE(arrival);
  const auto& report = std::get<RunsReport>(*arrival);
  EXPECT_EQ(report.robot.str(), "mapper-01");
  EXPECT_EQ(report.digest.str(), std::string(64, 'd'));
  EXPECT_EQ(report.applied_at, Stamp{7});
  EXPECT_EQ(report.who, "agent");
  EXPECT_TRUE(std::holds_alternative<Refusal>(*FromIdl(sample, OriginOf("robot/stranger"))));
  sample.digest[3] = 'x';
  EXPECT_FALSE(FromIdl(sample, OriginOf("robot/mapper-01"))) << "nobody can be answered about it";
}

TEST(FromIdl, NobodyIsToldWhereNobodyIs) {
  std::vector<std::uint8_t> bytes = {1};
  EXPECT_FALSE(FromIdl(ChunkOf(bytes), wire::SampleOrigin{}));  // the writer is gone
  EXPECT_FALSE(FromIdl(ChunkOf(bytes), OriginOf("operator")));
  rigcal_wire_Chunk bad_id = ChunkOf(bytes);
  bad_id.session_id[5] = '/';
  EXPECT_FALSE(FromIdl(bad_id, OriginOf("robot/mapper-01")));
  rigcal_wire_Chunk bad_robot = ChunkOf(bytes);
  std::strcpy(bad_robot.robot_id, "../../etc");
  EXPECT_FALSE(FromIdl(bad_robot, OriginOf("robot/mapper-01")));
}

TEST(FromIdl, SizesAreBounded) {
  std::vector<std::uint8_t> none, most(limits::kChunkBytesMax), more(limits::kChunkBytesMax + 1);
  EXPECT_TRUE(std::holds_alternative<Refusal>(*FromIdl(ChunkOf(none), OriginOf("robot/mapper-01"))));
  EXPECT_TRUE(std::holds_alternative<ChunkBytes>(*FromIdl(ChunkOf(most), OriginOf("robot/mapper-01"))));
  EXPECT_TRUE(std::holds_alternative<Refusal>(*FromIdl(ChunkOf(more), OriginOf("robot/mapper-01"))));
}

TEST(RobotOfPartition, ReadsOnlyRobotPartitions) {
  EXPECT_EQ(RobotOfPartition("robot/a")->str(), "a");
  for (const char* other : {"operator", "robot/", "robot/*", "robot", "xrobot/a", "robot/a/b"})
    EXPECT_FALSE(RobotOfPartition(other)) << other;
}

}  // namespace
}  // namespace rigcal::dds
