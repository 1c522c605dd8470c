// A capture session: what a technician has on disk (docs/session-format.md) and its canonical manifest.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/math/se3.h"

namespace rigcal {

// Pinhole with radial-tangential distortion, OpenCV's order k1 k2 p1 p2 k3. Pixel (0,0) is the centre of the first pixel.
struct PinholeRadtan {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion = {0, 0, 0, 0, 0};
};

enum class SensorKind { kCamera, kLidar, kTracker, kPoseStream };  // "camera" | "lidar" | "tracker" | "pose_stream"
[[nodiscard]] std::string NameOf(SensorKind kind);
[[nodiscard]] Result<SensorKind> SensorKindOf(const std::string& name);

struct Sensor {
  SensorId id;
  SensorKind kind = SensorKind::kCamera;
  std::optional<PinholeRadtan> intrinsics;   // given; absent: estimated from the captures
  std::optional<std::vector<double>> intrinsics_sigma;  // 9 values in the order fx fy cx cy k1 k2 p1 p2 k3, if known
  std::optional<TargetId> sees;              // the one target this sensor looks at; absent: any
  std::optional<Se3> T_ref_nominal;          // CAD pose of the sensor in the reference sensor
};

struct Checkerboard {
  TargetId id;
  int inner_cols = 0, inner_rows = 0;        // inner corners
  double square_m = 0.0;
  double square_sigma_m = 0.0;               // uncertainty of the measured square size (of the mean); 0: taken as exact
  std::string serial;
};

struct SessionHeader {
  int format = 1;
  RobotId robot;
  std::string rig_model;
  Stamp captured_at;
  std::string operator_name;
  SensorId reference;
  std::vector<Checkerboard> targets;
  std::vector<Sensor> sensors;
  std::map<std::string, std::string> conditions;
};

// One file of the session. `path` is relative, '/'-separated, "<sensor>/<capture>.<suffix>".
struct Payload {
  std::string path;
  SensorId sensor;
  CaptureId capture;
  Digest digest;
  std::int64_t size_bytes = 0;
};

// The session as a value: header (session.yaml, parsed) and payloads sorted by path.
struct Manifest {
  SessionHeader header;
  std::vector<Payload> payloads;
};

// One sensor by itself: a camera (no other kind is accepted yet), intrinsics in range, nominal pose finite and unit.
[[nodiscard]] Status Validate(const Sensor& sensor);
// One target by itself: corner counts (one odd, one even) and sizes in range.
[[nodiscard]] Status Validate(const Checkerboard& target);
// Reference and targets exist, names unique, counts and sizes in range, payloads of known sensors. The error names
// the sensor, target or file.
[[nodiscard]] Status Validate(const SessionHeader& header);
[[nodiscard]] Status Validate(const Manifest& manifest);

struct SensorPair {
  SensorId a, b;
  friend auto operator<=>(const SensorPair&, const SensorPair&) = default;
};
// All pairs of sensors of a session that this version can calibrate: cameras that may see the same target; a < b in the
// order of the session's sensors.
[[nodiscard]] std::vector<SensorPair> PairsToCalibrate(const SessionHeader& header);

}  // namespace rigcal
