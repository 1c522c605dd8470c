// Poses along a chain of frames that transforms of one or several messages make.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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
  // Whether the pose of `child` in `frame` hangs on the transform of `link`, as far as the chain is there.
  [[nodiscard]] bool IsBetween(const std::string& link, const std::string& frame, const std::string& child) const;
  // What contradicts itself from `child` up to `frame`: a frame that was in two others, or one that is said to be
  // static and was elsewhere. Empty: nothing.
  [[nodiscard]] std::string Doubt(const std::string& frame, const std::string& child) const;
  // Why Pose has nothing, of all that came.
  [[nodiscard]] std::string WhyNone(const std::string& frame, const std::string& child) const;

 private:
  struct Link {
    std::string parent;
    Se3 T_parent_child;
    std::int64_t stamp_ns = 0;
    bool is_static = false;
    std::string doubt;  // the first that was found; it stays
  };
  // From `child` up, to `frame` or as far as it goes: each frame, and its transform in the one above.
  [[nodiscard]] std::vector<std::pair<std::string, const Link*>> Chain(const std::string& frame,
                                                                       const std::string& child) const;
  [[nodiscard]] bool IsKnown(const std::string& frame) const;

  std::map<std::string, Link> links_;  // by child
};

// "/base_link" of ROS 1 is "base_link".
[[nodiscard]] std::string PlainFrame(const std::string& frame);

}  // namespace rigcal::importing
