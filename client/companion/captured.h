// What a session folder that grows holds so far, with every picture looked at.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "client/check/cameras.h"

namespace rigcal::companion {

// One camera so far, with what the planning of placements needs.
struct CameraSoFar {
  check::CameraFound found;
  std::optional<CameraIntrinsics> intrinsics;  // given, or estimated so far; absent: its pictures do not tell them
  std::map<CaptureId, std::vector<int>> corner_idx;   // of the board, in captures with a pose in `found`
  std::map<CaptureId, std::vector<Se3>> other_poses;  // T_cam_board that fit almost as well: small boards have two
  double corner_sigma_px = 0.0;                       // of one coordinate, by the residuals; 0: not told
};
// Pure but for `lenses`, which remembers. `pictures` of the camera.
[[nodiscard]] CameraSoFar FindCameraSoFar(const SessionHeader& header, const Sensor& camera,
                                          const std::map<CaptureId, check::PictureSeen>& pictures,
                                          calib::CameraMemory& lenses);

struct Captured {
  SessionHeader header;
  std::map<SensorId, std::map<CaptureId, check::PictureSeen>> pictures;
  std::map<SensorId, CameraSoFar> cameras;        // of every camera of the header
  std::map<SensorId, std::set<CaptureId>> files;  // of cameras and lidars
  std::vector<std::string> refusals;              // files that a push would refuse: sentences
  bool is_looking = false;                        // files wait to be looked at
};
// That any camera or lidar has a file of, in the order in which they were taken.
[[nodiscard]] std::vector<CaptureId> CapturesOf(const Captured& captured);

}  // namespace rigcal::companion
