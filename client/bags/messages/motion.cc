#include "client/bags/messages/motion.h"

#include <cmath>

#include "server/base/text.h"

namespace rigcal::bags {
namespace {

constexpr double kUnitTolerance = 1e-2;

Eigen::Vector3d VectorOf(const Value& value) {
  const double nan = std::nan("");
  return {value["x"].Real(nan), value["y"].Real(nan), value["z"].Real(nan)};
}

Result<Se3> PoseOf(const Value& translation, const Value& rotation) {
  Se3 T;
  T.p_m = VectorOf(translation);
  T.q = Eigen::Quaterniond(rotation["w"].Real(std::nan("")), rotation["x"].Real(), rotation["y"].Real(),
                           rotation["z"].Real());
  if (!T.p_m.allFinite() || !T.q.coeffs().allFinite())
    return RefuseMessage("the pose has values that are not finite, or not all of them");
  if (std::abs(T.q.norm() - 1) > kUnitTolerance)
    return RefuseMessage("the pose has a quaternion of length " + std::to_string(T.q.norm()));
  return T.Normalized();
}

}  // namespace

Result<StampedPose> ReadPose(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  if (!header) return RefuseMessage("the pose has no header");
  StampedPose stamped{*header, std::string(message["child_frame_id"].Text()), {}};
  if (const Value& transform = message["transform"]; !transform.IsAbsent()) {
    RIGCAL_ASSIGN(stamped.T_frame_child, PoseOf(transform["translation"], transform["rotation"]));
    return stamped;
  }
  const Value* pose = &message["pose"];
  if (const Value& inner = (*pose)["pose"]; !inner.IsAbsent()) pose = &inner;  // with a covariance beside it
  RIGCAL_ASSIGN(stamped.T_frame_child, PoseOf((*pose)["position"], (*pose)["orientation"]));
  return stamped;
}

Result<std::vector<StampedPose>> ReadTransforms(const Value& message) {
  std::vector<StampedPose> all;
  for (const Value& item : message["transforms"].items()) {
    auto one = ReadPose(item);
    if (!one)
      return Fail(one.error().code,
                  "from " + Quoted(item["header"]["frame_id"].Text()) + " to " + Quoted(item["child_frame_id"].Text()) +
                      ": " + one.error().what,
                  one.error().cure);
    all.push_back(*std::move(one));
  }
  return all;
}

Result<Imu> ReadImu(const Value& message) {
  const auto header = HeaderOf(message["header"]);
  if (!header) return RefuseMessage("the IMU's message has no header");
  Imu imu{*header, VectorOf(message["angular_velocity"]), VectorOf(message["linear_acceleration"])};
  if (!imu.angular_velocity_rad_s.allFinite() || !imu.acceleration_m_s2.allFinite())
    return RefuseMessage("the IMU's message has values that are not finite");
  return imu;
}

}  // namespace rigcal::bags
