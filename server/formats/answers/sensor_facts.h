// The document of the verb `sensors` (docs/api.md): what the sensors of a revision are, and the intrinsics that belong
// to the poses of its cameras.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/result.h"
#include "server/model/edges/edge.h"
#include "server/model/sensors/camera_fit.h"
#include "server/model/sessions/session.h"

namespace rigcal::formats {

struct SensorFacts {
  SensorId sensor;
  std::optional<SensorKind> kind = {};  // as the newest session that lists it says; absent: only finished edges name it
  // Of a camera, without views: the lens that belongs to its pose. Absent: no edge of the revision estimated or was
  // given any.
  std::optional<CameraFit> camera = {};
  EdgeId edge = {};           // with `camera`: the edge that speaks for it
  SessionId refined_in = {};  // with `camera`: whose refinement as a whole the lens is of; none: the edge's
};
struct SensorFactsOfRevision {
  RobotId robot;
  int revision = 0;
  std::vector<SensorFacts> sensors;  // in the order of the revision's document
};

[[nodiscard]] std::string WriteSensorFacts(const SensorFactsOfRevision& facts);
// Bounded, validated; a kind that this version does not know is absent. The error names the field.
[[nodiscard]] Result<SensorFactsOfRevision> ReadSensorFacts(std::string_view text);

}  // namespace rigcal::formats
