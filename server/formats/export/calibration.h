// One robot's calibration as other programs get it: poses and the intrinsics that belong to them, and what is left out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers/sensor_facts.h"
#include "server/formats/documents.h"

namespace rigcal::exports {

struct ExportedSensor {
  SensorId sensor;
  std::string frame;                       // its name in the file
  std::optional<SensorKind> kind = {};     // absent: nobody said it
  Se3 T_root_sensor;                       // p_root = T_root_sensor * p_sensor
  Matrix6d covariance = Matrix6d::Zero();  // of T_root_sensor, right tangent at the sensor, m and rad; zero of the root
  std::optional<CameraFit> camera = {};    // with intrinsics and a size, without views; absent: not known
  // A camera looks along +z, with x to the right and y down in the picture.
  [[nodiscard]] bool is_camera() const { return camera || kind == SensorKind::kCamera; }
};

struct Calibration {
  RobotId robot;
  int revision = 0;
  std::string standing;                     // "in use", "candidate", ...: where the revision is in its life
  std::optional<Stamp> calibrated_at = {};  // as of when all sensors were measured; absent: not known
  SensorId root;                            // the sensor in whose frame all poses are
  std::vector<ExportedSensor> sensors;      // the root first, then in the order of the revision; whole poses only
  std::vector<std::string> left_out = {};   // sentences without a full stop: what is in no file, and why
  std::map<SensorId, std::string> without_pose = {};  // sensors of left_out, and why: "the height was not measured"

  // Null: it is in no file.
  [[nodiscard]] const ExportedSensor* Find(const SensorId& sensor) const;
  [[nodiscard]] const std::string& root_frame() const { return sensors.front().frame; }
};

// In the frame of the revision's reference, whose covariances they are. Sensors of which not every direction was
// measured are left out by name and axis. `facts`: absent where the server does not tell kinds and intrinsics, which is
// told. kNotFound where the revision has no whole pose.
[[nodiscard]] Result<Calibration> CalibrationOf(const formats::RevisionInput& revision,
                                                const std::optional<formats::SensorFactsOfRevision>& facts);

// The same calibration in the frame of `root`. Poses are composed. The covariance of the former root is Ad(T) C Ad(T)^T
// of the new root's own; that of any other sensor is that of `relative`: of its pose in the new root, right tangent at
// the sensor, as `lookup` answers it from what the solution knows of both together. A sensor without one is left out,
// and named. kNotFound where the root has no whole pose: the error lists those that have.
[[nodiscard]] Result<Calibration> Rebased(Calibration calibration, const SensorId& root,
                                          const std::map<SensorId, Matrix6d>& relative);

// Names of frames in the file instead of the sensors' own. kNotFound names a sensor that the calibration lacks,
// kInvalidInput one name for two of them, and one with characters that the formats cannot hold (letters, digits and _ -
// . / are taken).
[[nodiscard]] Status RenameFrames(Calibration& calibration, const std::map<SensorId, std::string>& frames);

}  // namespace rigcal::exports
