// What the files of a session folder show, one by one.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/model/sensors/features.h"
#include "server/model/sensors/pose_table.h"
#include "server/model/sessions/session.h"

namespace rigcal::check {

struct TargetSeen {
  BoardView view;  // as the server's jobs see it; of a picture that cannot be read 0 x 0, with the reason
  std::optional<double> edge_px;  // EdgeWidth_px of a board that was found
};

struct PictureSeen {
  std::string path;
  std::string why_not;                  // it cannot be read, with what to do; empty: it can
  int width_px = 0, height_px = 0;      // 0 x 0: it cannot be read
  std::map<TargetId, TargetSeen> seen;  // of every target that the camera may see
};

struct CloudSeen {
  std::string path;
  std::string why_not;     // likewise
  std::string note;        // what is odd about its points; empty: nothing
  std::size_t points = 0;  // with a return
};

struct SessionSeen {
  Manifest manifest;            // of what a push would take
  std::vector<Error> refusals;  // of the rest, as SurveySessionFolder
  std::map<SensorId, std::map<CaptureId, PictureSeen>> pictures;
  std::map<SensorId, std::map<CaptureId, CloudSeen>> clouds;
  std::map<SensorId, PoseTable> poses;  // of trackers and pose streams
};

}  // namespace rigcal::check
