#include <gmock/gmock.h>

#include <cmath>

#include "client/bags/messages/cloud.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "tests/unit/bags/cdr_message.h"

namespace rigcal::bags {
namespace {

using ::testing::HasSubstr;

DecodedMessage ImageOf(std::uint32_t width, std::uint32_t height, const std::string& encoding, std::uint32_t step,
                       std::size_t bytes) {
  CdrMessage message;
  message.Header(12, 34, "cam")
      .Put(height)
      .Put(width)
      .Text(encoding)
      .Put(std::uint8_t{0})
      .Put(step)
      .Block(std::string(bytes, 'p'));
  return {"sensor_msgs/msg/Image", message};
}

TEST(Messages, APictureIsCheckedAgainstItsBytes) {
  const DecodedMessage good = ImageOf(4, 3, "bgr8", 16, 16 * 2 + 12);  // the last row without its padding
  const auto image = ReadImage(good.value);
  ASSERT_TRUE(image) << image.error().what;
  EXPECT_EQ(image->header.stamp_ns, 12'000'000'034);
  EXPECT_EQ(image->header.frame, "cam");
  EXPECT_FALSE(ReadImage(ImageOf(4, 3, "bgr8", 16, 16 * 2 + 11).value));
  EXPECT_FALSE(ReadImage(ImageOf(4, 3, "bgr8", 11, 100).value));
  EXPECT_FALSE(ReadImage(ImageOf(0, 3, "bgr8", 12, 100).value));
  EXPECT_FALSE(ReadImage(ImageOf(70'000, 1, "mono8", 70'000, 70'000).value));
  EXPECT_FALSE(ReadImage(ImageOf(0xFFFFFFFF, 0xFFFFFFFF, "bgr8", 0xFFFFFFFF, 100).value));
  EXPECT_FALSE(ReadImage(ImageOf(3, 1, "yuv422", 6, 6).value));
  EXPECT_THAT(ReadImage(ImageOf(4, 3, "32FC1", 16, 48).value).error().what, HasSubstr("\"32FC1\""));
}

TEST(Messages, ACompressedPictureIsWhatItsBytesSay) {
  CdrMessage jpeg, depth;
  jpeg.Header(1, 2, "c").Text("png; of course").Block("\xFF\xD8\xFF\xE0 and so on");
  depth.Header(1, 2, "c").Text("16UC1; compressedDepth png").Block("0123456789");
  EXPECT_EQ(ReadCompressedImage(DecodedMessage("sensor_msgs/CompressedImage", jpeg).value)->suffix, "jpg");
  EXPECT_THAT(ReadCompressedImage(DecodedMessage("sensor_msgs/CompressedImage", depth).value).error().what,
              HasSubstr("compressedDepth"));
}

DecodedMessage CloudOf(std::uint32_t width, std::uint32_t height, std::uint32_t offset_z, std::uint32_t point_step,
                       std::uint32_t row_step, std::size_t bytes) {
  CdrMessage message;
  message.Header(0, 1, "lidar").Put(height).Put(width).Put(std::uint32_t{3});
  message.Text("z").Put(offset_z).Put(std::uint8_t{7}).Put(std::uint32_t{1});
  message.Text("x").Put(std::uint32_t{0}).Put(std::uint8_t{7}).Put(std::uint32_t{0});
  message.Text("y").Put(std::uint32_t{4}).Put(std::uint8_t{7}).Put(std::uint32_t{1});
  message.Put(std::uint8_t{0}).Put(point_step).Put(row_step).Block(std::string(bytes, '\0')).Put(std::uint8_t{1});
  return {"sensor_msgs/msg/PointCloud2", message};
}

TEST(Messages, ACloudIsCheckedAgainstItsBytes) {
  const DecodedMessage good = CloudOf(5, 2, 8, 12, 64, 128);
  const auto cloud = ReadPointCloud(good.value);
  ASSERT_TRUE(cloud) << cloud.error().what;
  EXPECT_EQ(cloud->fields[0].name, "x");
  EXPECT_EQ(cloud->fields[2].name, "z");
  EXPECT_TRUE(ReadPointCloud(CloudOf(5, 1, 8, 12, 0, 60).value));  // one row, row_step left out
  EXPECT_FALSE(ReadPointCloud(CloudOf(5, 2, 8, 12, 64, 127).value));
  EXPECT_FALSE(ReadPointCloud(CloudOf(5, 2, 9, 12, 64, 128).value));  // z beyond the point
  EXPECT_FALSE(ReadPointCloud(CloudOf(0, 2, 8, 12, 64, 128).value));
  EXPECT_FALSE(ReadPointCloud(CloudOf(0xFFFFFFFF, 0xFFFFFFFF, 8, 12, 0xFFFFFFFF, 128).value));
  EXPECT_FALSE(ReadPointCloud(CloudOf(5, 2, 8, 0, 0, 0).value));
}

// The message is read by the definition that stands in the bag, whatever it makes of the numbers.
TEST(Messages, ACloudWhoseDefinitionHasLongerNumbersIsRefused) {
  const auto refusal = [](std::int64_t offset, std::int64_t count, std::int64_t point_step) {
    Topic topic;
    topic.name = "/t", topic.type = "sensor_msgs/msg/PointCloud2", topic.encoding = "cdr",
    topic.schema_encoding = "ros2msg";
    topic.schema =
        "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\nint64 "
        "point_step\nint64 row_step\nuint8[] data\n===\nMSG: sensor_msgs/PointField\nstring name\nint64 offset\n"
        "uint8 datatype\nint64 count\n";
    CdrMessage message;
    message.Header(0, 1, "lidar").Put(std::uint32_t{1}).Put(std::uint32_t{2}).Put(std::uint32_t{3});
    for (const char* name : {"x", "y", "z"}) message.Text(name).Put(offset).Put(std::uint8_t{7}).Put(count);
    message.Put(std::uint8_t{0}).Put(point_step).Put(std::int64_t{0}).Block(std::string(24, '\0'));
    const std::vector<std::byte> bytes = message.Done();
    const auto definition = DefinitionOf(topic);
    EXPECT_TRUE(definition) << definition.error().what;
    const auto value = Decode(topic, **definition, bytes);
    EXPECT_TRUE(value) << value.error().what;
    const auto cloud = ReadPointCloud(*value);
    return cloud ? "" : cloud.error().what;
  };
  EXPECT_EQ(refusal(0, 1, 12), "");
  EXPECT_THAT(refusal(-1'000'000'000'000, 1, 12), HasSubstr("beyond 32 bits"));
  EXPECT_THAT(refusal(-4'000'000'000'000, 1'000'000'000'001, 12), HasSubstr("beyond 32 bits")) << "their sum fits";
  EXPECT_THAT(refusal(1LL << 40, 1, 1LL << 62), HasSubstr("beyond 32 bits"));
}

TEST(Messages, AStampBeyondItsBitsIsNone) {
  Topic topic;
  topic.name = "/t", topic.type = "std_msgs/msg/Header", topic.encoding = "cdr", topic.schema_encoding = "ros2msg";
  topic.schema = "Stamp stamp\nstring frame_id\n===\nMSG: std_msgs/Stamp\nint64 sec\nint64 nanosec\n";
  const auto definition = DefinitionOf(topic).value();
  const auto header_of = [&](std::int64_t sec, std::int64_t nanosec) {
    const std::vector<std::byte> bytes = CdrMessage().Put(sec).Put(nanosec).Text("cam").Done();
    return HeaderOf(Decode(topic, *definition, bytes).value());
  };
  EXPECT_EQ(header_of(12, 34)->stamp_ns, 12'000'000'034);
  EXPECT_FALSE(header_of(INT64_MAX, 0));
  EXPECT_FALSE(header_of(0, INT64_MIN));
}

TEST(Messages, PosesAreOfUnitLengthAndFinite) {
  const auto pose_of = [](double w, double x) {
    CdrMessage message;
    message.Header(-1, 999'999'999, "map").Put(1.0).Put(2.0).Put(3.0).Put(x).Put(0.0).Put(0.0).Put(w);
    return DecodedMessage("geometry_msgs/msg/PoseStamped", message);
  };
  const auto pose = ReadPose(pose_of(0.6, 0.8).value);
  ASSERT_TRUE(pose) << pose.error().what;
  EXPECT_EQ(pose->header.stamp_ns, -1);
  EXPECT_EQ(pose->T_frame_child.p_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(pose->T_frame_child.q.x(), 0.8, 1e-15);
  EXPECT_FALSE(ReadPose(pose_of(0, 0).value));
  EXPECT_FALSE(ReadPose(pose_of(std::nan(""), 0).value));
  EXPECT_FALSE(ReadPose(pose_of(0.6, 0.9).value));
}

TEST(Messages, ACameraInfoHasItsLens) {
  CdrMessage message;
  message.Header(3, 0, "c")
      .Put(std::uint32_t{480})
      .Put(std::uint32_t{640})
      .Text("plumb_bob")
      .List<double>({1, 2, 3, 4, 5});
  for (const double k : {500.0, 0.0, 320.0, 0.0, 501.0, 240.0, 0.0, 0.0, 1.0}) message.Put(k);
  for (int i = 0; i < 21; ++i) message.Put(0.0);
  message.Put(std::uint32_t{0})
      .Put(std::uint32_t{0})
      .Put(std::uint32_t{0})
      .Put(std::uint32_t{0})
      .Put(std::uint32_t{0})
      .Put(std::uint32_t{0})
      .Put(std::uint8_t{0});
  const DecodedMessage decoded("sensor_msgs/msg/CameraInfo", message);
  const auto info = ReadCameraInfo(decoded.value);
  ASSERT_TRUE(info) << info.error().what;
  EXPECT_EQ(info->fy_px, 501);
  EXPECT_EQ(info->cx_px, 320);
  EXPECT_EQ(info->distortion, (std::vector<double>{1, 2, 3, 4, 5}));
}

TEST(Messages, AScanHasItsAngles) {
  CdrMessage message;
  message.Header(3, 0, "l")
      .Put(-1.5F)
      .Put(1.5F)
      .Put(0.5F)
      .Put(0.0F)
      .Put(0.1F)
      .Put(0.2F)
      .Put(30.0F)
      .List<float>({1, 2, 3})
      .List<float>({});
  const auto scan = ReadLaserScan(DecodedMessage("sensor_msgs/msg/LaserScan", message).value);
  ASSERT_TRUE(scan) << scan.error().what;
  EXPECT_EQ(scan->angle_min_rad, -1.5);
  EXPECT_EQ(scan->ranges_m, (std::vector<float>{1, 2, 3}));
  EXPECT_TRUE(scan->intensities.empty());
}

}  // namespace
}  // namespace rigcal::bags
