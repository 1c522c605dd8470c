// A capture session: what a technician has on disk (docs/session-format.md) and its canonical manifest.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/ids.h"
#include "server/base/stamp.h"
#include "server/math/se3.h"
#include "server/model/sensors/camera.h"
#include "server/model/sensors/cloud_layout.h"
#include "server/model/sensors/target.h"

namespace rigcal {

// A tracker and a pose stream have one file, "<sensor>/poses.csv": as a payload its capture has this name.
inline constexpr std::string_view kPoseTableStem = "poses";

enum class SensorKind { kCamera, kLidar, kTracker, kPoseStream };  // "camera" | "lidar" | "tracker" | "pose_stream"
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(SensorKind kind);
[[nodiscard]] Result<SensorKind> SensorKindOf(const std::string& name);

// Of the files that a sensor of this kind has, without the dot: "png", ...; "pcd", ...; "csv".
[[nodiscard]] const std::vector<std::string_view>& SuffixesOf(SensorKind kind);

struct Sensor {
  SensorId id;
  SensorKind kind = SensorKind::kCamera;
  CameraModel camera_model = CameraModel::kPinholeRadtan;  // of a camera: what its intrinsics are, or are estimated as
  std::optional<CameraIntrinsics> intrinsics;           // of camera_model, given; absent: estimated from the captures
  std::optional<std::vector<double>> intrinsics_sigma;  // fx fy cx cy and the distortion's, in its order, if known
  std::optional<double>
      range_bias_sigma_m;               // of a lidar: how far all its ranges may be off together; absent: not known
  std::optional<double> clock_sigma_s;  // of a tracker: how far its clock may be off; absent: not known
  std::optional<TargetId> sees;         // the one target this sensor looks at; absent: any
  std::optional<Se3> T_ref_nominal;     // CAD pose of the sensor in the reference sensor
  std::optional<CloudLayout> layout;    // of a lidar: of its .bin files; absent: KITTI's, where a file leaves no doubt
  // Of the part that is mounted there, one line each; empty: not told. Where it is another one than on the visit
  // before, an epoch of the sensor begins (epoch.h).
  std::string serial = {}, firmware = {};
  friend bool operator==(const Sensor&, const Sensor&) = default;
};

// "none" | "gicp": the pose of two lidars is NDT's, or polished from there by generalised ICP.
enum class LidarPolish { kNone, kGicp };
// The spelling in documents, and back: kInvalidInput, with the known ones, for any other.
[[nodiscard]] std::string NameOf(LidarPolish polish);
[[nodiscard]] Result<LidarPolish> LidarPolishOf(const std::string& name);

struct SensorPair {
  SensorId a, b;
  friend auto operator<=>(const SensorPair&, const SensorPair&) = default;
};

struct SessionHeader {
  int format = 1;
  RobotId robot;
  std::string rig_model;
  Stamp captured_at;
  std::string operator_name;
  SensorId reference;
  std::vector<Target> targets;
  std::vector<Sensor> sensors;
  std::vector<SensorPair> skip_pairs;  // not to be calibrated; in either order
  std::vector<SensorId> remounted;     // moved on purpose since the sessions before: what those say of them is past
  LidarPolish lidar_polish = LidarPolish::kNone;  // of all its pairs of lidars; kNone where there are none
  std::map<std::string, std::string> conditions;
};

// One file of the session. `path` is relative, '/'-separated, "<sensor>/<capture>.<suffix>" or "<sensor>/poses.csv".
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

// Of a session before it is taken in: no camera may take one board for another, which its pictures cannot tell apart.
// The error names the camera and the two boards.
[[nodiscard]] Status CheckBoardsApart(const SessionHeader& header);

// One sensor by itself: what its kind does not have is absent, intrinsics in range, nominal pose finite and unit.
[[nodiscard]] Status Validate(const Sensor& sensor);
// One file by itself: its sensor is of the session, its path as the sensor's kind has it, its size in range.
[[nodiscard]] Status Validate(const Payload& payload, const SessionHeader& header);
// Reference and targets exist, names unique, counts and sizes in range, payloads of known sensors. The error names
// the sensor, target or file.
[[nodiscard]] Status Validate(const SessionHeader& header);
[[nodiscard]] Status Validate(const Manifest& manifest);

// The sensor of this name; null: the session has none.
[[nodiscard]] const Sensor* SensorOf(const SessionHeader& header, const SensorId& id);
// What its .bin files hold, if the session says it.
[[nodiscard]] std::optional<CloudLayout> LayoutOf(const SessionHeader& header, const SensorId& lidar);
// Whether a target is mounted on what this tracker reports. Then the sensor stands for the world of its poses (a
// robot's base), not for the body that moves (its flange): that is what cameras beside the robot are tied to.
[[nodiscard]] bool CarriesTarget(const SessionHeader& header, const SensorId& tracker);
// The targets that both may see.
[[nodiscard]] std::vector<const Target*> CommonTargets(const SessionHeader& header, const Sensor& a, const Sensor& b);
// Captures that a camera or a lidar has a file of, by name.
[[nodiscard]] std::vector<CaptureId> RecordedCaptures(const Manifest& manifest);
// Captures in which both have one and the same file, by the digests: a copying mistake, and no measurement. In the
// manifest's order.
[[nodiscard]] std::vector<CaptureId> SamePictures(const Manifest& manifest, const SensorPair& pair);

// All pairs of sensors of a session that there is a method (method.h) for and that are not to be skipped; a < b in the
// order of the session's sensors.
[[nodiscard]] std::vector<SensorPair> PairsToCalibrate(const SessionHeader& header);
// Whether the session says that these two are not to be calibrated, in either order.
[[nodiscard]] bool IsSkipped(const SessionHeader& header, const SensorId& a, const SensorId& b);
// Whether the session has two lidars that are calibrated with each other.
[[nodiscard]] bool HasLidarPair(const SessionHeader& header);
// T_a_b as drawn; nothing where the drawing lacks one of the two. The reference sensor need not be drawn.
[[nodiscard]] std::optional<Se3> NominalPose(const SessionHeader& header, const Sensor& a, const Sensor& b);

}  // namespace rigcal
