// Rig files in YAML: static transforms of tf2, Autoware's sensor kit, Kalibr's camera chain.
#pragma once

#include <string>
#include <string_view>

#include "server/formats/rig_files/frames.h"

namespace rigcal::rig_files {

// tf2: `transforms`, a list of geometry_msgs/TransformStamped: pose of child_frame_id in header.frame_id, quaternion x
// y z w. Autoware: FRAME: {CHILD: {x, y, z, roll, pitch, yaw}}, pose of CHILD in FRAME, fixed axes; a child
// NAME/camera_link becomes the optical frame NAME inside it. Kalibr: cam0, cam1, ...; T_cn_cnm1 maps points of the
// camera before into this one. A frame is called as rigcal_frame says, else cam0, cam1, ... Errors as of ReadRigFile.
[[nodiscard]] Result<RigFile> ReadYamlRig(std::string_view text, const std::string& name);

}  // namespace rigcal::rig_files
