// What most messages begin with: when it was measured, and in which frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/bags/messages/value.h"

namespace rigcal::bags {

struct Header {
  std::int64_t stamp_ns = 0;  // of the clock that the driver stamps by
  std::string frame;          // "left_camera_optical"
};
// Of a decoded std_msgs/Header; nothing where it is none.
[[nodiscard]] std::optional<Header> HeaderOf(const Value& header);
// Of a message that begins with one; nothing where its type does not.
[[nodiscard]] Result<std::optional<Header>> ReadHeader(const Topic& topic, const Definition& definition, Bytes bytes);

// What a message type is to Rigcal.
enum class MessageKind {
  kImage,
  kCompressedImage,
  kCameraInfo,
  kCloud,
  kScan,
  kImu,
  kPose,
  kOdometry,
  kTransforms,
  kOther
};
// By the type's name, however it is spelt.
[[nodiscard]] MessageKind KindOf(std::string_view type);

// Of one that a typed reader refuses. `what` says what of the message is wrong.
[[nodiscard]] tl::unexpected<Error> RefuseMessage(
    const std::string& what, const std::string& cure = "The message is left out; mend what sends it.");

}  // namespace rigcal::bags
