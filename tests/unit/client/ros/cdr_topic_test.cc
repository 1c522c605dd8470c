// Bytes of any type over the wire, against readers and writers that were made for the type.
#include "idl/ros/cdr_topic.h"

#include <gmock/gmock.h>

#include <functional>

#include "idl/ros/publishers.h"
#include "tests/unit/client/ros/ros_reader.h"
#include "tests/unit/formats/export_sample.h"

namespace rigcal::client {
namespace {

using CdrBytes = std::vector<std::byte>;
using std::chrono::milliseconds;

const wire::RosTopic kStatic{"/tf_static", "tf2_msgs/msg/TFMessage"};
constexpr wire::RosQos kLatched{true, true, 1};

// Waits for news of `entity` until `done`.
bool AwaitNews(const wire::Participant& participant, dds_entity_t entity, const std::function<bool()>& done) {
  auto waitset = wire::WaitSet::Open(participant).value();
  EXPECT_TRUE(waitset.Attach(entity));
  const auto end = std::chrono::steady_clock::now() + kRosPatience;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    EXPECT_TRUE(waitset.Wait(milliseconds(100)));
  }
  return true;
}

CdrBytes NextBytes(const wire::Participant& participant, wire::CdrReader& reader) {
  CdrBytes bytes;
  EXPECT_TRUE(AwaitNews(participant, reader.get(), [&] {
    EXPECT_TRUE(reader.Take([&](const wire::CdrMessage& message) {
      bytes.assign(message.bytes.begin(), message.bytes.end());
      EXPECT_GT(message.sent_ns, 0);
      EXPECT_NE(message.publication, 0U);
    }));
    return !bytes.empty();
  }));
  return bytes;
}

TEST(RosNames, AreMangledAsRos2DoesAndBack) {
  const std::pair<const char*, const char*> topics[] = {{"/left/image_raw", "rt/left/image_raw"}, {"/tf", "rt/tf"}};
  for (const auto& [ros, wire_name] : topics) {
    EXPECT_EQ(wire::WireTopicOf(ros), wire_name);
    EXPECT_EQ(wire::RosTopicOf(wire_name), ros);
  }
  for (const char* other : {"rq/add_two_intsRequest", "ros_discovery_info", "DCPSParticipant", ""})
    EXPECT_FALSE(wire::RosTopicOf(other)) << other;
  const std::pair<const char*, const char*> types[] = {{"sensor_msgs/msg/Image", "sensor_msgs::msg::dds_::Image_"},
                                                       {"tf2_msgs/msg/TFMessage", "tf2_msgs::msg::dds_::TFMessage_"}};
  for (const auto& [ros, wire_name] : types) {
    EXPECT_EQ(wire::WireTypeOf(ros), wire_name);
    EXPECT_EQ(wire::RosTypeOf(wire_name), ros);
  }
  EXPECT_EQ(wire::RosTypeOf("Temperature"), "Temperature");
  EXPECT_EQ(wire::WireTypeOf("Temperature"), "Temperature");
}

TEST(CdrTopic, AreTheBytesThatAReaderOfTheTypeHas) {
  const wire::Participant theirs = RosTestParticipant(), ours = RosTestParticipant();  // one has one type of a name
  const RosReader<wire::RosTransforms> typed(theirs, "rt/tf_static");
  auto untyped = wire::CdrReader::Open(ours, kStatic, kLatched).value();
  auto broadcast = RosBroadcast::Open(RosTestSide()).value();
  ASSERT_TRUE(broadcast.Publish(exports::sample::Rig()));
  const CdrBytes wanted = typed.Next(theirs), got = NextBytes(ours, untyped);
  ASSERT_GT(wanted.size(), 50U);
  EXPECT_EQ(got, wanted);
}

TEST(CdrTopic, ReachAReaderOfTheTypeAsTheyAre) {
  CdrBytes sent;
  {
    const wire::Participant participant = RosTestParticipant();
    const RosReader<wire::RosTransforms> reader(participant, "rt/tf_static");
    auto broadcast = RosBroadcast::Open(RosTestSide()).value();
    ASSERT_TRUE(broadcast.Publish(exports::sample::Rig()));
    sent = reader.Next(participant);
  }
  const wire::Participant theirs = RosTestParticipant(), ours = RosTestParticipant();
  auto writer = wire::CdrWriter::Open(ours, kStatic, kLatched).value();
  ASSERT_TRUE(writer.Write(sent));
  const RosReader<wire::RosTransforms> late(theirs, "rt/tf_static");
  EXPECT_EQ(late.Next(theirs), sent) << "who comes late is given it, too";
  EXPECT_EQ(late.Writer().type, "tf2_msgs::msg::dds_::TFMessage_");
}

TEST(CdrTopic, AnyTypeAndAnySizeOfMessage) {
  const wire::RosTopic topic{"/any", "their_msgs/msg/Any"};
  const wire::Participant participant = RosTestParticipant();
  for (const bool reliable : {true, false}) {
    auto reader = wire::CdrReader::Open(participant, topic, {reliable, false, 0}).value();
    auto writer = wire::CdrWriter::Open(participant, topic, {reliable, false, 0}).value();
    for (const std::size_t size : {4U, 5U, 7U, 100'001U}) {
      CdrBytes sent(size, std::byte{7});
      ASSERT_TRUE(writer.Write(sent));
      const CdrBytes got = NextBytes(participant, reader);
      EXPECT_EQ(got, sent) << size;
    }
  }
}

TEST(RosPublishers, ComeAndEndWithWhatTheyOffer) {
  const wire::Participant participant = RosTestParticipant();
  auto publishers = wire::RosPublishers::Open(participant).value();
  wire::RosPublishers::News seen;
  const auto look = [&] {
    const auto news = publishers.Look().value();
    seen.came.insert(seen.came.end(), news.came.begin(), news.came.end());
    seen.ended.insert(seen.ended.end(), news.ended.begin(), news.ended.end());
  };
  {
    const auto writer =
        wire::CdrWriter::Open(participant, {"/seen", "sensor_msgs/msg/Image"}, {false, false, 5}).value();
    ASSERT_TRUE(AwaitNews(participant, publishers.get(), [&] { return look(), !seen.came.empty(); }));
    const wire::RosPublisher& publisher = publishers.Met().at(seen.came.front());
    EXPECT_EQ(publisher.topic.name, "/seen");
    EXPECT_EQ(publisher.topic.type, "sensor_msgs/msg/Image");
    EXPECT_FALSE(publisher.qos.reliable);
    EXPECT_FALSE(publisher.qos.transient_local);
    EXPECT_TRUE(publisher.is_there);
  }
  ASSERT_TRUE(AwaitNews(participant, publishers.get(), [&] { return look(), !seen.ended.empty(); }));
  EXPECT_EQ(seen.ended, seen.came);
  EXPECT_FALSE(publishers.Met().at(seen.ended.front()).is_there);
}

}  // namespace
}  // namespace rigcal::client
