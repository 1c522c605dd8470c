#include "client/bags/messages/header.h"

#include <limits>
#include <map>

namespace rigcal::bags {

std::optional<Header> HeaderOf(const Value& header) {
  const Value& stamp = header["stamp"];
  if (stamp["sec"].IsAbsent() || stamp["nanosec"].IsAbsent()) return std::nullopt;
  // Both have 32 bits, unless a bag's own definition says otherwise: no sum of such is beyond int64.
  constexpr std::int64_t kWordMax = std::numeric_limits<std::uint32_t>::max();
  const std::int64_t sec = stamp["sec"].Integer(), nanosec = stamp["nanosec"].Integer();
  if (sec < -kWordMax || sec > kWordMax || nanosec < 0 || nanosec > kWordMax) return std::nullopt;
  return Header{sec * 1'000'000'000 + nanosec, std::string(header["frame_id"].Text())};
}

Result<std::optional<Header>> ReadHeader(const Topic& topic, const Definition& definition, Bytes bytes) {
  const auto& fields = definition.root->fields;
  if (fields.empty() || fields[0].type == nullptr || fields[0].type->name != "std_msgs/Header" ||
      fields[0].arity != Arity::kOne)
    return std::nullopt;
  RIGCAL_ASSIGN(const Value value, Decode(topic, definition, bytes, 1));
  return HeaderOf(value.items()[0]);
}

MessageKind KindOf(std::string_view type) {
  static const std::map<std::string, MessageKind> kKinds = {
      {"sensor_msgs/Image", MessageKind::kImage},
      {"sensor_msgs/CompressedImage", MessageKind::kCompressedImage},
      {"sensor_msgs/CameraInfo", MessageKind::kCameraInfo},
      {"sensor_msgs/PointCloud2", MessageKind::kCloud},
      {"sensor_msgs/LaserScan", MessageKind::kScan},
      {"sensor_msgs/Imu", MessageKind::kImu},
      {"geometry_msgs/PoseStamped", MessageKind::kPose},
      {"geometry_msgs/PoseWithCovarianceStamped", MessageKind::kPose},
      {"geometry_msgs/TransformStamped", MessageKind::kPose},
      {"nav_msgs/Odometry", MessageKind::kOdometry},
      {"tf2_msgs/TFMessage", MessageKind::kTransforms},
      {"tf/tfMessage", MessageKind::kTransforms}};
  const auto found = kKinds.find(PlainTypeName(type));
  return found == kKinds.end() ? MessageKind::kOther : found->second;
}

tl::unexpected<Error> RefuseMessage(const std::string& what, const std::string& cure) {
  return Fail(ErrorCode::kInvalidInput, what, cure);
}

}  // namespace rigcal::bags
