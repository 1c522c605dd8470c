// READ: the poses that a tracker or a pose stream reports.
#pragma once

#include "server/model/sensors/pose_table.h"
#include "server/model/sessions/session.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// An error where there is no table, or none that can be read; kStorage only if the store failed.
[[nodiscard]] Result<PoseTable> LoadPoses(storage::Store& store, const Manifest& manifest, const Sensor& sensor);
// Where a tracker's body was between its captures; empty where its file does not tell. Errors are those of LoadPoses.
[[nodiscard]] Result<PoseTable> LoadTrackerPath(storage::Store& store, const Manifest& manifest, const Sensor& tracker);

}  // namespace rigcal::pipeline
