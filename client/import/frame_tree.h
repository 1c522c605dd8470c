// Poses along a chain of frames that transforms of one or several messages make.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "client/bags/messages/motion.h"

namespace rigcal::importing {

class FrameTree {
 public:
  // The newest transform of its child. A static one holds for all time.
  void Add(const bags::StampedPose& transform, bool is_static);
  // The pose of `child` in `frame`, which is above it, at the stamp of the newest transform between. Nothing: there is
  // no such chain yet, all of it is static, or its transforms are further apart than `tolerance_ns`.
  [[nodiscard]] std::optional<bags::StampedPose> Pose(const std::string& frame, const std::string& child,
                                                      std::int64_t tolerance_ns) const;

 private:
  struct Link {
    std::string parent;
    Se3 T_parent_child;
    std::int64_t stamp_ns = 0;
    bool is_static = false;
  };
  std::map<std::string, Link> links_;  // by child
};

// "/base_link" of ROS 1 is "base_link".
[[nodiscard]] std::string PlainFrame(const std::string& frame);

}  // namespace rigcal::importing
