// A feature-level visit as the joint refinement takes it.
#pragma once

#include "server/calib/joint/problem/session_start.h"
#include "tests/bench/rig/feature_session.h"

namespace rigcal {

// `T_ref_sensor` is the start: the solved graph's poses, or the nominal ones.
[[nodiscard]] calib::joint::SessionViews ViewsOf(const FeatureSession& session, std::map<SensorId, Se3> T_ref_sensor);
[[nodiscard]] std::map<SensorId, Se3> NominalPoses(const FeatureSession& session);

}  // namespace rigcal
