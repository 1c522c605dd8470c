// A kind of machine as it is drawn: which sensors it has, where they sit, which pairs must be calibrated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/base/ids.h"
#include "server/math/se3.h"
#include "server/model/approval/policy.h"
#include "server/model/approval/standing.h"
#include "server/model/sessions/session.h"

namespace rigcal {

struct ExpectedSensor {
  SensorId id;
  SensorKind kind = SensorKind::kCamera;
  std::optional<Se3> T_ref_sensor;  // as drawn, in the model's reference sensor; of that itself the identity
  PoseLimit tolerance;              // of T_ref_sensor: a robot's may be this far from it; 0 without a pose
  friend bool operator==(const ExpectedSensor&, const ExpectedSensor&) = default;
};

struct RigModel {
  std::string name;                     // as session.yaml has it, `rig_model`; empty: there is none
  SensorId reference;                   // one of the sensors
  std::vector<ExpectedSensor> sensors;  // in the order in which they were written
  std::vector<SensorPair> required_pairs;
  friend bool operator==(const RigModel&, const RigModel&) = default;
};

// Names unique, poses finite and plausible with a tolerance above zero, pairs of two different sensors of the model.
// The error names the sensor or pair.
[[nodiscard]] Status Validate(const RigModel& model);

[[nodiscard]] const ExpectedSensor* SensorOf(const RigModel& model, const SensorId& id);  // null: it has none
// T_from_sensor as drawn; nothing where one of both has no place in the drawing.
[[nodiscard]] std::optional<Se3> NominalPose(const RigModel& model, const SensorId& from, const SensorId& sensor);

// A rig model as somebody set it.
struct RigModelVersion {
  std::string name;
  std::int64_t number = 0;   // order of arrival among those of all names
  std::int64_t version = 0;  // of its name, from 1
  Word word;
  std::string text;  // YAML
};

// What is expected of one robot.
struct ExpectedRig {
  RigModel model;              // without a name: nothing is expected
  std::int64_t version = 0;    // RigModelVersion's
  std::int64_t watermark = 0;  // number of the newest of all rig models: what was set later is not in it
};

}  // namespace rigcal
