// READ: whether a robot may rely on a revision, and which one it falls back to.
#pragma once

#include "server/model/approval/validity.h"
#include "server/model/graph/graph.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// The revision that the robot is to use: that which is in use (decisions.h). None where none is, where it counts what
// was retired since, or a sensor was remounted since that one was solved and a newer revision knows it: its poses are
// of another rig.
[[nodiscard]] Result<std::optional<UsableRevision>> LoadUsable(storage::Store& store, const RobotId& robot);
// Likewise the one that could take its place: what was in use before it, if anything of that still holds.
[[nodiscard]] Result<std::optional<Revision>> LoadFallback(storage::Store& store, const RobotId& robot);
// `calculating`: whether jobs of the robot wait, or edges that its newest revision does not hold; or `given_up`.
[[nodiscard]] Status LoadWhatIsNew(storage::Store& store, const RobotId& robot, Validity& validity);
[[nodiscard]] Result<Validity> LoadValidity(storage::Store& store, const Revision& revision, Stamp now);

}  // namespace rigcal::pipeline
