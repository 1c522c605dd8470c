// What goes over the wire is what ROS 2 sends: its bytes as others recorded them, its names of topics and types, its
// QoS.
#include <gmock/gmock.h>

#include <cstring>

#include "client/bags/open_bag.h"
#include "tests/unit/client/ros/ros_reader.h"
#include "tests/unit/formats/export_sample.h"
#include "tests/unit/recordings.h"

namespace rigcal::client {
namespace {

using Bytes = std::vector<std::byte>;
using exports::sample::Rig;
using std::chrono::milliseconds;

constexpr const char* kAllTypes = "bags/formats/alltypes/alltypes.mcap";
constexpr std::size_t kHeader_bytes = 4;  // of the encapsulation; its last two say how much padding the sender added

Bytes RecordedMessage(const std::string& type) {
  const auto bag = bags::OpenBag(Recording(kAllTypes)).value();
  for (bags::Message message; bag->Next(message);)
    if (message.topic->type == type) return {message.bytes.begin(), message.bytes.end()};
  return {};
}

Stamp StampAt(const Bytes& bytes, std::size_t at) {
  std::uint32_t sec = 0, nanosec = 0;
  std::memcpy(&sec, bytes.data() + at, 4);
  std::memcpy(&nanosec, bytes.data() + at + 4, 4);
  return {static_cast<std::int64_t>(sec) * 1'000'000'000 + nanosec};
}

// Senders may fill the last word.
void ExpectSameBody(Bytes ours, Bytes theirs) {
  ASSERT_GT(ours.size(), kHeader_bytes);
  EXPECT_EQ(ours[0], std::byte{0});
  EXPECT_EQ(ours[1], std::byte{1}) << "plain CDR, least byte first";
  while (ours.size() % 4 != 0) ours.push_back(std::byte{0});
  while (theirs.size() % 4 != 0) theirs.push_back(std::byte{0});
  EXPECT_EQ(Bytes(ours.begin() + kHeader_bytes, ours.end()), Bytes(theirs.begin() + kHeader_bytes, theirs.end()));
}

template <typename T>
Bytes OnTheWire(const T& sample) {
  const wire::Participant participant = RosTestParticipant();
  const RosReader<T> reader(participant, wire::InfoOf<T>().name);
  auto writer = wire::Writer<T>::Open(participant, {}).value();
  EXPECT_TRUE(writer.Write(sample));
  return reader.Next(participant);
}

TEST(RosWire, TransformsAreTheBytesThatRos2Recorded) {
  RIGCAL_SKIP_WITHOUT_RECORDING(kAllTypes);
  const Bytes recorded = RecordedMessage("tf2_msgs/msg/TFMessage");
  ASSERT_GT(recorded.size(), 16U);
  exports::Calibration pair;
  pair.root = SensorId("a");
  pair.sensors = {{SensorId("a"), "test_frame", {}, {}}, {SensorId("b"), "child_frame", {}, {}}};
  pair.sensors[1].T_root_sensor.p_m = {1, 2, 3};
  ExpectSameBody(OnTheWire(TransformsOf(pair, StampAt(recorded, 8)).sample), recorded);
}

TEST(RosWire, CameraInfoIsTheBytesThatRos2Recorded) {
  RIGCAL_SKIP_WITHOUT_RECORDING(kAllTypes);
  const Bytes recorded = RecordedMessage("sensor_msgs/msg/CameraInfo");
  ASSERT_GT(recorded.size(), 16U);
  exports::ExportedSensor camera{SensorId("a"), "test_frame", SensorKind::kCamera, {}};
  camera.camera = exports::sample::Camera("a", CameraModel::kPinholeRadtan, {0.1, -0.2, 0.001, 0.002, 0.0});
  camera.camera->intrinsics.fx_px = camera.camera->intrinsics.fy_px = 525;
  camera.camera->intrinsics.cx_px = 320, camera.camera->intrinsics.cy_px = 240;
  auto message = CameraInfoOf(camera, StampAt(recorded, 4));
  message.sample.binning_x = message.sample.binning_y = 1;  // as its sender had it
  ExpectSameBody(OnTheWire(message.sample), recorded);
}

TEST(RosBroadcast, IsWhatTf2sListenersAskFor) {
  auto broadcast = RosBroadcast::Open(RosTestSide()).value();
  const auto left_out = broadcast.Publish(Rig());
  ASSERT_TRUE(left_out) << left_out.error().what;
  EXPECT_THAT(broadcast.Topics(), testing::ElementsAre("/tf_static", "/left/camera_info", "/right/camera_info"));
  const wire::Participant participant = RosTestParticipant();
  const RosReader<wire::RosTransforms> transforms(participant, "rt/tf_static");
  const RosReader<wire::RosCameraInfo> camera(participant, "rt/left/camera_info");
  EXPECT_FALSE(transforms.Next(participant).empty()) << "who comes late is told";
  EXPECT_FALSE(camera.Next(participant).empty());
  const RosWriterSeen tf = transforms.Writer(), info = camera.Writer();
  EXPECT_EQ(tf.type, "tf2_msgs::msg::dds_::TFMessage_");
  EXPECT_EQ(info.type, "sensor_msgs::msg::dds_::CameraInfo_");
  for (const RosWriterSeen& seen : {tf, info}) {
    EXPECT_EQ(seen.reliability, DDS_RELIABILITY_RELIABLE);
    EXPECT_EQ(seen.durability, DDS_DURABILITY_TRANSIENT_LOCAL);
    EXPECT_EQ(seen.partitions, 0U);
  }
}

TEST(RosBroadcast, WhoComesLateIsToldTheNewestAlone) {
  auto broadcast = RosBroadcast::Open(RosTestSide()).value();
  exports::Calibration rig = Rig();
  ASSERT_TRUE(broadcast.Publish(rig));
  rig.sensors.resize(2);
  ASSERT_TRUE(broadcast.Publish(rig));
  const wire::Participant participant = RosTestParticipant();
  const RosReader<wire::RosTransforms> reader(participant, "rt/tf_static");
  const Bytes first = reader.Next(participant);
  ASSERT_GT(first.size(), 8U);
  EXPECT_EQ(first[kHeader_bytes], std::byte{1}) << "one transform";
  ASSERT_TRUE(broadcast.Publish(Rig()));
  EXPECT_EQ(reader.Next(participant)[kHeader_bytes], std::byte{4}) << "who is there is told anew";
}

TEST(RosBroadcast, WithdrawnIsToldToNobodyWhoComes) {
  auto broadcast = RosBroadcast::Open(RosTestSide()).value();
  ASSERT_TRUE(broadcast.Publish(Rig()));
  broadcast.Withdraw();
  EXPECT_FALSE(broadcast.is_published());
  const wire::Participant participant = RosTestParticipant();
  EXPECT_FALSE(RosReader<wire::RosTransforms>(participant, "rt/tf_static").WaitForWriter(milliseconds(500)));
}

TEST(RosBroadcast, AwaitsThoseThatAreThere) {
  auto broadcast = RosBroadcast::Open(RosTestSide()).value();
  ASSERT_TRUE(broadcast.Publish(Rig()));
  const auto nobody = broadcast.AwaitReaders(milliseconds(300));
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().code, ErrorCode::kUnreachable);
  EXPECT_EQ(nobody.error().what, "nobody in ROS domain 73 reads /tf_static (waited 0.3 s)");
  const wire::Participant participant = RosTestParticipant();
  const RosReader<wire::RosTransforms> reader(participant, "rt/tf_static");
  EXPECT_TRUE(broadcast.AwaitReaders(kRosPatience));
  EXPECT_FALSE(reader.Next(participant).empty());
}

// Transforms are of use without lenses.
TEST(RosBroadcast, WithoutALensIsSaidAndNoError) {
  auto broadcast = RosBroadcast::Open(RosTestSide()).value();
  exports::Calibration rig = Rig();
  for (exports::ExportedSensor& sensor : rig.sensors) sensor.camera.reset();
  const auto left_out = broadcast.Publish(rig);
  ASSERT_TRUE(left_out);
  EXPECT_THAT(*left_out, testing::Contains("left: a camera of which no intrinsics are known"));
  EXPECT_THAT(*left_out, testing::Contains(testing::HasSubstr("camera_info: no camera of mapper-01 has intrinsics")));
  EXPECT_THAT(broadcast.Topics(), testing::ElementsAre("/tf_static"));
}

}  // namespace
}  // namespace rigcal::client
