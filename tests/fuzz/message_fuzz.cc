// A message type's text and bytes of it, by every typed reader.
#include "client/bags/messages/cloud.h"
#include "client/bags/messages/image.h"
#include "client/bags/messages/motion.h"
#include "tests/fuzz/fuzz.h"

using namespace rigcal;

namespace {

void Check(const bags::Value& value) {
  if (const auto image = bags::ReadImage(value); fuzz::RequireGoodError(image))
    fuzz::Require(
        static_cast<std::int64_t>(image->data.size()) >= std::int64_t{image->step_bytes} * (image->height_px - 1) +
                                                             image->width_px * bags::PixelBytes(image->encoding),
        "every row is there");
  if (const auto cloud = bags::ReadPointCloud(value); fuzz::RequireGoodError(cloud)) {
    fuzz::Require(cloud->data.size() >= cloud->row_bytes * cloud->height, "every point is there");
    for (const bags::PointField& field : cloud->fields)
      fuzz::Require(field.offset_bytes + field.count * bags::SizeOf(field.type) <= cloud->point_bytes,
                    "a field lies in its point");
  }
  if (const auto pose = bags::ReadPose(value); fuzz::RequireGoodError(pose)) {
    fuzz::RequireFinite(pose->T_frame_child.p_m, "position");
    fuzz::Require(std::abs(pose->T_frame_child.q.norm() - 1) < 1e-9, "a quaternion has unit length");
  }
  if (const auto imu = bags::ReadImu(value); fuzz::RequireGoodError(imu))
    fuzz::RequireFinite(imu->acceleration_m_s2, "acceleration");
  fuzz::RequireGoodError(bags::ReadCompressedImage(value));
  fuzz::RequireGoodError(bags::ReadCameraInfo(value));
  fuzz::RequireGoodError(bags::ReadLaserScan(value));
  fuzz::RequireGoodError(bags::ReadTransforms(value));
  fuzz::Require(value.SameAs(value), "a value is the same as itself");
}

}  // namespace

// Of the first byte: which encoding and which kind of text; two bytes of length, the text of the type a/A, the bytes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kKnown[] = {"a/A",
                                    "sensor_msgs/Image",
                                    "sensor_msgs/PointCloud2",
                                    "sensor_msgs/CameraInfo",
                                    "sensor_msgs/LaserScan",
                                    "sensor_msgs/Imu",
                                    "geometry_msgs/PoseStamped",
                                    "tf2_msgs/TFMessage",
                                    "nav_msgs/Odometry",
                                    "sensor_msgs/CompressedImage"};
  fuzz::Input input(data, size);
  const auto choice = input.Number<std::uint8_t>();
  bags::Topic topic{"/t", kKnown[choice / 4U % std::size(kKnown)], choice % 2 == 0 ? "cdr" : "ros1", "", ""};
  const auto text_bytes = input.Number<std::uint16_t>();
  topic.schema = input.Take(text_bytes);
  if (!topic.schema.empty()) topic.schema_encoding = choice % 4 < 2 ? "ros2msg" : "ros2idl";
  const auto definition = bags::DefinitionOf(topic);
  if (!fuzz::RequireGoodError(definition)) return 0;
  const auto value = bags::Decode(topic, **definition, std::as_bytes(std::span(input.rest())));
  if (fuzz::RequireGoodError(value)) Check(*value);
  return 0;
}
