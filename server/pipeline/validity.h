// READ: whether a robot may rely on a revision, and which one it falls back to.
#pragma once

#include "server/model/graph.h"
#include "server/model/validity.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// The revision that the robot is to use: that which is in use (storage/decisions.h), or the one before it where it counts what was
// retired since. None where none was approved, or a sensor was remounted since that one was solved and a newer revision knows it: its
// poses are of another rig.
[[nodiscard]] Result<std::optional<UsableRevision>> LoadUsable(storage::Store& store, const RobotId& robot);
// `calculating`: whether jobs of the robot wait, or edges that its newest revision does not hold; or `given_up`.
[[nodiscard]] Status LoadWhatIsNew(storage::Store& store, const RobotId& robot, Validity& validity);
[[nodiscard]] Result<Validity> LoadValidity(storage::Store& store, const Revision& revision, Stamp now);

}  // namespace rigcal::pipeline
