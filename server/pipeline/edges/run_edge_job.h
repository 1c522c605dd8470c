// From a stored session to one finished edge: the file to read first.
#pragma once

#include "server/base/stamp.h"
#include "server/calib/camera/camera_memory.h"
#include "server/model/edges/edge.h"
#include "storage/work/jobs.h"

namespace rigcal::pipeline {

// Loads the pair's captures, detects (cached by content), estimates with its jackknife, and commits the edge together
// with the end of the job. What cannot be calibrated becomes a failed edge with its diagnoses, never an error; an error
// means that the store or the server itself failed (no memory) and the job is still waiting. It is begun kAttemptsMax
// times, deaths of the process included; then it becomes a failed edge that says so. One job of a robot at a time.
[[nodiscard]] Result<Edge> RunEdgeJob(storage::Store& store, const storage::JobRow& job, const Clock& clock,
                                      calib::CameraMemory& cameras);

}  // namespace rigcal::pipeline
