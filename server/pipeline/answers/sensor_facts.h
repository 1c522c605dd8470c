// What the sensors of a revision are, and the intrinsics that belong to its cameras (the verb `sensors`).
#pragma once

#include "server/formats/answers/sensor_facts.h"
#include "server/model/graph/graph.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ. Kinds are those of the newest session that lists the sensor; intrinsics are those that the revision's report
// shows, one set per camera (report/cameras/camera_choice.h), without the places of corners.
[[nodiscard]] Result<formats::SensorFactsOfRevision> LoadSensorFacts(storage::Store& store, const Revision& revision);

}  // namespace rigcal::pipeline
