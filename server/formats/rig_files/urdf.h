// The joints of a URDF robot, with the places of what may be changed in its text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/formats/rig_files/frames.h"

namespace rigcal::rig_files {

struct UrdfJoint {
  std::string name;
  FramePose pose;             // fixed: its type is "fixed"
  std::size_t line = 0;       // of the joint, from 1
  std::size_t joint_at = 0;   // of the joint's "<" in the text
  std::size_t origin_at = 0;  // of the origin's "<"; meaningful with has_origin
  bool has_origin = false;    // without: the identity
};

struct Urdf {
  std::vector<std::string> links;
  std::vector<UrdfJoint> joints;  // in the order of the text
};

// Of plain URDF; `name` starts every error. kUnsupported of a xacro file that is not expanded: the cure is the command
// that does it. kInvalidInput names line and joint: no XML, no robot, a joint without parent or child, numbers that are
// none.
[[nodiscard]] Result<Urdf> ReadUrdf(std::string_view text, const std::string& name);

}  // namespace rigcal::rig_files
