#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <random>
#include <thread>

#include "idl/dds.h"

namespace rigcal::wire {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kPatience{60'000};

ParticipantOptions RandomOptions() {
  std::random_device random;
  ParticipantOptions options;
  options.tag = "test-" + std::to_string(random());
  return options;
}

Participant MustOpen(const ParticipantOptions& options) {
  auto participant = Participant::Open(options);
  if (!participant) throw std::runtime_error(Sentence(participant.error()));
  return std::move(*participant);
}

rigcal_wire_RobotStatus StatusOf(const char* robot, std::uint32_t revision) {
  static char why[] = "";
  rigcal_wire_RobotStatus sample{};
  std::strcpy(sample.robot_id, robot);
  sample.why = why;
  sample.revision = revision;
  return sample;
}

TEST(Participant, RefusesBadDomainAndTag) {
  ParticipantOptions options = RandomOptions();
  options.domain = 231;
  EXPECT_FALSE(Participant::Open(options));
  options.domain = 0;
  options.tag = "</Tag>";
  const auto refused = Participant::Open(options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
}

TEST(Participant, OneTagPerDomainWhileOneLives) {
  const ParticipantOptions first = RandomOptions(), second = RandomOptions();
  {
    const Participant open = MustOpen(first);
    EXPECT_TRUE(Participant::Open(first));
    const auto refused = Participant::Open(second);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kConflict);
  }
  EXPECT_TRUE(Participant::Open(second));
}

TEST(Endpoints, WildcardReaderHearsLiteralWriterAndKnowsItsPartition) {
  const ParticipantOptions options = RandomOptions();
  Participant server = MustOpen(options), robot = MustOpen(options);
  auto reader = Reader<rigcal_wire_RobotStatus>::Open(server, {kAllRobotsPartition});
  auto writer = Writer<rigcal_wire_RobotStatus>::Open(robot, {RobotPartition(RobotId("mapper-01"))});
  ASSERT_TRUE(reader && writer);
  ASSERT_TRUE(writer->WaitForReader(kPatience));
  ASSERT_TRUE(reader->WaitForWriter(kPatience));
  ASSERT_TRUE(writer->Write(StatusOf("mapper-01", 3)));
  auto waitset = WaitSet::Open(server);
  ASSERT_TRUE(waitset);
  ASSERT_TRUE(waitset->Attach(reader->get()));
  ASSERT_TRUE(waitset->Wait(kPatience));
  int heard = 0;
  const auto taken = reader->Take(10, [&](const rigcal_wire_RobotStatus& sample, const SampleOrigin& origin) {
    ++heard;
    EXPECT_EQ(sample.revision, 3u);
    EXPECT_THAT(origin.partitions, testing::ElementsAre("robot/mapper-01"));
    EXPECT_NE(origin.participant, 0u);
  });
  ASSERT_TRUE(taken);
  EXPECT_EQ(heard, 1);
  ASSERT_EQ(reader->Matched().size(), 1u);
  EXPECT_THAT(reader->Matched().front().partitions, testing::ElementsAre("robot/mapper-01"));
}

TEST(Endpoints, OtherPartitionsDoNotMatch) {
  const ParticipantOptions options = RandomOptions();
  Participant participant = MustOpen(options);
  auto reader = Reader<rigcal_wire_Event>::Open(participant, {"robot/a"});
  auto writer = Writer<rigcal_wire_Event>::Open(participant, {"robot/b"});
  ASSERT_TRUE(reader && writer);
  const Status waited = writer->WaitForReader(milliseconds(50));
  ASSERT_FALSE(waited);
  EXPECT_EQ(waited.error().code, ErrorCode::kUnreachable);
}

TEST(Endpoints, LateJoinersGetTheNewestOfEachKey) {
  const ParticipantOptions options = RandomOptions();
  Participant server = MustOpen(options), late = MustOpen(options);
  auto writer = Writer<rigcal_wire_RobotStatus>::Open(server, {"robot/a"});
  ASSERT_TRUE(writer);
  for (std::uint32_t revision = 1; revision <= 5; ++revision) ASSERT_TRUE(writer->Write(StatusOf("a", revision)));
  ASSERT_TRUE(writer->Write(StatusOf("b", 9)));
  ASSERT_TRUE(writer->Write(StatusOf("c", 9)));
  ASSERT_TRUE(writer->Forget(StatusOf("c", 0)));
  auto reader = Reader<rigcal_wire_RobotStatus>::Open(late, {"robot/a"});
  auto waitset = WaitSet::Open(late);
  ASSERT_TRUE(reader && waitset && waitset->Attach(reader->get()));
  std::map<std::string, std::uint32_t> heard;
  while (heard.size() < 2) {
    ASSERT_TRUE(*waitset->Wait(kPatience));
    ASSERT_TRUE(reader->Take(10, [&](const auto& sample, const auto&) { heard[sample.robot_id] = sample.revision; }));
  }
  EXPECT_THAT(heard, testing::ElementsAre(std::pair("a", 5u), std::pair("b", 9u)));
}

TEST(Endpoints, AWriterWhoseReaderDoesNotTakeIsBusyAndRecovers) {
  const ParticipantOptions options = RandomOptions();
  Participant participant = MustOpen(options);
  auto reader = Reader<rigcal_wire_Manifest>::Open(participant, {"robot/a"});
  auto writer = Writer<rigcal_wire_Manifest>::Open(participant, {"robot/a"});
  ASSERT_TRUE(reader && writer);
  ASSERT_TRUE(writer->WaitForReader(kPatience));
  rigcal_wire_Manifest sample{};
  std::strcpy(sample.robot_id, "a");
  Status status;
  for (int i = 0; i < 100 && status; ++i) status = writer->Write(sample);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kBusy);
  ASSERT_TRUE(reader->Take(100, [](const auto&, const auto&) {}));
  EXPECT_TRUE(writer->Write(sample));
}

TEST(WaitSet, SleepsAgainAfterAMatch) {
  const ParticipantOptions options = RandomOptions();
  Participant participant = MustOpen(options);
  auto reader = Reader<rigcal_wire_Event>::Open(participant, {"robot/a"});
  auto writer = Writer<rigcal_wire_Reply>::Open(participant, {"operator"});
  auto waitset = WaitSet::Open(participant);
  ASSERT_TRUE(reader && writer && waitset && waitset->Attach(reader->get()) && waitset->Attach(writer->get()));
  auto event_writer = Writer<rigcal_wire_Event>::Open(participant, {"robot/a"});
  auto reply_reader = Reader<rigcal_wire_Reply>::Open(participant, {"operator"});
  ASSERT_TRUE(event_writer && reply_reader);
  int woken = 0;
  while (woken < 100 && *waitset->Wait(milliseconds(20))) ++woken;
  EXPECT_GE(woken, 1);
  EXPECT_LE(woken, 4);  // as often as something changed, not as often as one asks
}

TEST(WaitSet, IsWokenFromAnotherThreadAndByDataLeftBehind) {
  const ParticipantOptions options = RandomOptions();
  Participant participant = MustOpen(options);
  auto waitset = WaitSet::Open(participant);
  ASSERT_TRUE(waitset);
  std::thread waker([&] { waitset->Wake(); });
  EXPECT_TRUE(*waitset->Wait(kPatience));
  waker.join();
  auto reader = Reader<rigcal_wire_Event>::Open(participant, {"robot/a"});
  auto writer = Writer<rigcal_wire_Event>::Open(participant, {"robot/a"});
  ASSERT_TRUE(reader && writer && waitset->Attach(reader->get()));
  rigcal_wire_Event sample{};
  char json[] = "{}";
  sample.json = json;
  ASSERT_TRUE(writer->Write(sample) && writer->Write(sample));
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(*waitset->Wait(kPatience));
    EXPECT_EQ(*reader->Take(1, [](const auto&, const auto&) {}), 1);
  }
}

TEST(Writer, KnowsWhoseReaderCame) {
  const ParticipantOptions options = RandomOptions();
  Participant participant = MustOpen(options), other = MustOpen(options);
  auto writer = Writer<rigcal_wire_Reply>::Open(participant, {"operator"});
  ASSERT_TRUE(writer);
  Writer<rigcal_wire_Reply> moved = std::move(*writer);
  auto reader = Reader<rigcal_wire_Reply>::Open(other, {"operator"});
  auto request_writer = Writer<rigcal_wire_Request>::Open(other, {"operator"});
  auto request_reader = Reader<rigcal_wire_Request>::Open(participant, {"operator"});
  ASSERT_TRUE(reader && request_writer && request_reader);
  ASSERT_TRUE(moved.WaitForReader(kPatience));
  ASSERT_TRUE(request_reader->WaitForWriter(kPatience));
  EXPECT_TRUE(moved.HasReaderOf(request_reader->Matched().front().participant));
  EXPECT_FALSE(moved.HasReaderOf(12345));
}

TEST(Participant, ApartMeetsTheOthersOverTheNetwork) {
  ParticipantOptions options = RandomOptions();
  Participant participant = MustOpen(options);
  options.apart = true;
  Participant apart = MustOpen(options);
  auto writer = Writer<rigcal_wire_Event>::Open(participant, {"robot/a"});
  auto reader = Reader<rigcal_wire_Event>::Open(apart, {"robot/a"});
  auto waitset = WaitSet::Open(apart);
  ASSERT_TRUE(writer && reader && waitset && waitset->Attach(reader->get()));
  ASSERT_TRUE(writer->WaitForReader(kPatience) && reader->WaitForWriter(kPatience));
  rigcal_wire_Event sample{};
  char json[] = "{}";
  sample.json = json;
  ASSERT_TRUE(writer->Write(sample));
  int taken = 0;
  while (taken == 0) {
    ASSERT_TRUE(*waitset->Wait(kPatience));
    taken = *reader->Take(8, [](const auto&, const auto&) {});
  }
  EXPECT_EQ(taken, 1);
}

TEST(Participant, ApartHasTheTagOfItsKind) {
  ParticipantOptions options = RandomOptions();
  options.apart = true;
  Participant apart = MustOpen(options);
  ParticipantOptions other = RandomOptions();
  other.domain = options.domain;
  other.apart = true;
  EXPECT_EQ(Participant::Open(other).error().code, ErrorCode::kConflict);
}

}  // namespace
}  // namespace rigcal::wire
