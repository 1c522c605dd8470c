// From what each sensor saw and the solved graph of pairs to the session's problem and its start: which of a view's
// poses, which way round a board that looks alike when turned, which patch of a cloud is the board. Choices are those
// that agree with the pairs' poses over the whole session.
#pragma once

#include <map>
#include <set>

#include "server/base/result.h"
#include "server/calib/camera/intrinsics.h"
#include "server/calib/joint/problem/session_problem.h"
#include "server/model/sensors/pose_table.h"

namespace rigcal::calib::joint {

// A camera has one for each board that it saw.
struct CameraViews {
  Sensor camera;
  Target board;
  std::vector<std::pair<CaptureId, BoardView>> views;
  CameraEstimate estimate;  // of these views; its lens is that of the camera's first
};
struct LidarViews {
  Sensor lidar;
  std::map<CaptureId, std::vector<CloudView>> clouds;  // one per board that was looked for
};
struct TrackerPoses {
  Sensor tracker;
  PoseTable poses;
  PoseTable path = {};  // where its body was at other times, by stamp; empty: not told
};

struct SessionViews {
  SensorId reference;
  std::vector<Target> targets;
  std::vector<CameraViews> cameras;
  std::vector<LidarViews> lidars;
  std::vector<TrackerPoses> trackers;    // the first that tells poses is the world, each other has a world of its own
  bool boards_stand_still = false;       // all session long, in one world
  std::map<SensorId, Se3> T_ref_sensor;  // the solved graph's; sensors that are not here take no part
  struct Relative {
    SensorId a, b;
    Se3 T_a_b;
    Matrix6d Omega;
    int dof = 0;  // behind Omega; 0: known
  };
  std::vector<Relative> relatives;
};

enum class WhyUnused { kPlaceUnknown, kBehindTheCamera, kNoBoardThere };
struct UnusedLook {
  SensorId sensor;
  CaptureId capture;
  WhyUnused why = WhyUnused::kPlaceUnknown;
};

struct SessionStart {
  SessionProblem problem;
  SessionState state;
  std::vector<SensorNoise> noise;
  std::vector<UnusedLook> unused;
};

// `left_out` take no part. Fails with a sentence where nothing connects the sensors: no capture that two of them share.
[[nodiscard]] Result<SessionStart> StartOf(const SessionViews& views, const std::set<SensorId>& left_out = {});

}  // namespace rigcal::calib::joint
