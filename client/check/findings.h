// What a session folder holds and what would come of it: the values that are judged and told.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/check/pairs.h"

namespace rigcal::check {

struct FileTrouble {
  std::string path, why;  // one clause; what to do after a semicolon or a full stop
};

// Of every sensor.
struct SensorFiles {
  SensorId sensor;
  SensorKind kind = SensorKind::kCamera;
  std::size_t files = 0;
  std::vector<CaptureId> present;  // captures with a file, of a tracker with a row; in order. Of a stream: none
  std::size_t usable = 0;          // pictures with the board, clouds that can be read, rows
  std::vector<FileTrouble> unreadable;
};

struct LidarFound {
  SensorId lidar;
  std::size_t clouds = 0;  // that can be read
  std::size_t points_least = 0, points_most = 0;
  std::vector<FileTrouble> odd;
};

struct StreamFound {
  SensorId stream;
  std::size_t rows = 0;
  double seconds = 0.0;
  std::size_t gaps = 0;  // too long to be bridged (calib/motion/stream_motion.h)
  double longest_gap_s = 0.0;
};

struct Findings {
  RobotId robot;
  Stamp captured_at;
  std::vector<CaptureId> captures;   // that a camera or a lidar has a file of, in order
  std::vector<Error> refusals;       // what a push would refuse
  std::vector<SensorFiles> sensors;  // in the session's order
  std::map<SensorId, CameraFound> cameras;
  std::vector<LidarFound> lidars;
  std::vector<StreamFound> streams;
  std::vector<PairFound> pairs;
  std::vector<std::vector<std::string>> same_files;  // paths of one content
  std::map<std::string, std::string> unit_doubts;    // questions, by file
};

// Pure; deterministic. Cameras and pairs in parallel. Throws std::bad_alloc.
[[nodiscard]] Findings FindAll(const SessionSeen& session, const PairProgress& progress);

// Null: there is none of this name.
[[nodiscard]] const SensorFiles* FilesOf(const Findings& findings, const SensorId& sensor);
// It takes part in a pair that is calibrated.
[[nodiscard]] bool IsInPair(const Findings& findings, const SensorId& sensor);
// So many more are asked for where there are `held` and these are not enough: up to what the server asks for
// after a first visit, by the default policy.
[[nodiscard]] std::size_t CapturesMore(const Findings& findings, std::size_t held);
// What its pairs want most of it; zeros of a sensor in no pair that goes by captures.
[[nodiscard]] CapturesNeeded NeededOf(const Findings& findings, const SensorId& sensor);

}  // namespace rigcal::check
