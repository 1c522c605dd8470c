// What a camera's pictures of a session say together: of its board, its lens and its sharpness.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "client/check/seen.h"
#include "client/check/tilt_ring.h"
#include "server/calib/camera/camera_memory.h"
#include "server/model/sensors/coverage.h"

namespace rigcal::check {

struct BlurredPicture {
  CaptureId capture;
  double edge_px = 0.0;
};

struct BoardCount {
  Target board;
  std::size_t pictures = 0;  // that show it
};

struct CameraFound {
  SensorId camera;
  std::optional<Target> board;     // of those it may see, the one found in most pictures; absent: it may see none
  std::vector<BoardCount> boards;  // that it may see
  std::vector<CaptureId> with_board, without_board;  // of the pictures that can be read
  std::string why_not;                               // no board, in the first of those without
  std::size_t corners = 0;                           // in all pictures
  Coverage coverage;
  TiltRing ring;
  std::optional<BoardDistances> distances;
  std::optional<double> edge_px;  // of the edges of the boards, median of the pictures
  std::vector<BlurredPicture> blurred;
  int width_px = 0, height_px = 0;          // of most pictures
  std::vector<CaptureId> resized;           // the others
  bool estimates_lens = false;              // its intrinsics are not given
  bool fills_picture = true;                // not a wide lens, of which a part of the picture may stay dark
  std::optional<Diagnosis> lens_problem;    // why board poses and intrinsics cannot be had of these pictures
  std::optional<double> focal_sigma_ratio;  // of estimated intrinsics, on the axis along x
  std::map<CaptureId, Se3> T_cam_board;     // where the above is absent
};

// `lenses` remembers the camera for its pairs. Where intrinsics are to be estimated and cannot be, boards stand where a
// rough focal length puts them. Throws std::bad_alloc.
[[nodiscard]] CameraFound FindCamera(const Sensor& camera, const std::vector<const Target*>& targets,
                                     const std::map<CaptureId, PictureSeen>& pictures, calib::CameraMemory& lenses);

// Of the picture, those that no corner was near; of kSidesOfPicture.
[[nodiscard]] std::vector<std::string> EmptySides(const Coverage& coverage);
// Views of one target, of every picture.
[[nodiscard]] std::vector<std::pair<CaptureId, BoardView>> ViewsOf(const std::map<CaptureId, PictureSeen>& pictures,
                                                                   const TargetId& target);
// Of these targets the one found in most pictures, the first of equals; null of none.
[[nodiscard]] const Target* BestTarget(const std::vector<const Target*>& targets,
                                       const std::map<CaptureId, PictureSeen>& pictures);

}  // namespace rigcal::check
