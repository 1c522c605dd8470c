// Where the frames of a rig are by a file of another program, and the poses that follow from it.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/math/se3.h"

namespace rigcal::rig_files {

// One statement of a file.
struct FramePose {
  std::string parent, frame;
  Se3 T_parent_frame;  // p_parent = T_parent_frame * p_frame
  bool fixed = true;   // false: a joint that moves; the pose is that of its zero position
};

struct RigFile {
  std::string format;  // "urdf", "tf2", "autoware", "kalibr"
  std::vector<FramePose> poses;
};

inline constexpr std::size_t kRigFileBytesMax = 16u << 20;
inline constexpr std::size_t kFramesMax = 100'000;

// Of any of the four; which one its first characters and keys tell. `name` starts every error. Bounded, nothing beyond
// kPositionMax_m, unit quaternions, orthonormal matrices (both to 1e-3, then normalised). kInvalidInput names line or
// frame.
[[nodiscard]] Result<RigFile> ReadRigFile(std::string_view text, const std::string& name);

// Every frame that fixed statements tie to `root`, the root among them: p_root = T * p_frame. kNotFound where the file
// lacks the root, and names frames that it has; errors of CheckTree.
[[nodiscard]] Result<std::map<std::string, Se3>> PosesIn(const RigFile& file, const std::string& root);

// Of a frame as the file's text has it, its name in `file`: a key NAME/camera_link of Autoware's is read as NAME.
[[nodiscard]] std::string FrameAsRead(const RigFile& file, const std::string& frame);
// Every frame has one parent, and none stands below itself: kConflict names the one.
[[nodiscard]] Status CheckTree(const RigFile& file);
// A name of a file in a message: as it is where it is short and printable, else in quotes with escapes.
[[nodiscard]] std::string Shown(const std::string& name);
// Why angles of a file that are to be radians are none: "an angle of 90 is more ..."; empty: they may be.
[[nodiscard]] std::string WhyNoRadians(const Eigen::Vector3d& angles);
// "left, right, top and 3 more".
[[nodiscard]] std::string FramesText(const RigFile& file);

}  // namespace rigcal::rig_files
