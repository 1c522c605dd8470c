// The lenses that belong to a revision's poses.
#pragma once

#include <vector>

#include "server/model/graph/graph.h"
#include "server/report/cameras/camera_choice.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ. Each camera gets the lens that the newest of the sessions behind the revision's poses was refined with, where
// one refined it; what edges know of a camera alone fits its pictures without regard to the poses.
[[nodiscard]] Status TakeRefinedLenses(storage::Store& store, const RobotId& robot, const FusedSessions& fused,
                                       std::vector<report::CameraReport>& cameras);

}  // namespace rigcal::pipeline
