// A calibration put into an existing URDF: the origins of joints whose child is a sensor's link change, and no other
// byte.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/math/se3.h"

namespace rigcal::rig_files {

// Sensors by the names of their links: p_root = T_root_sensor * p_sensor.
struct LinkPoses {
  std::string root;  // a link that stays where the file has it: a calibration does not tell where the robot's base is
  std::map<std::string, Se3> poses;  // of the others; the root need not be among them
};

struct OriginChange {
  std::string joint, link;
  std::size_t line = 0;       // of the origin in the file as it was
  std::string before, after;  // the whole tag; before is empty where the joint had none
  double moved_m = 0.0, turned_rad = 0.0;
};

struct PatchedUrdf {
  std::string text;
  std::vector<OriginChange> changes;  // in the order of the file; a joint that is right already is none
  std::vector<std::string> left_out;  // sensors without a link in the file, or behind a joint that moves, and why
};

// `text`: plain URDF (ReadUrdf's errors), `name` starts every error. kNotFound where the root is no link of it: the
// cure lists links. kInvalidInput where no link of the file is one of the poses.
[[nodiscard]] Result<PatchedUrdf> PatchUrdf(std::string_view text, const std::string& name,
                                            const LinkPoses& calibrated);

}  // namespace rigcal::rig_files
