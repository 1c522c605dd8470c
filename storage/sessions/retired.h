// What was taken out by a word: edges, sessions, sensors that are gone from their robot. Append-only; of each the
// newest of "retired" and "restored" holds. Nothing that was measured is changed by it.
//
// Saying twice the same is saying it once: the first word holds. Each change is noted in the audit. kNotFound if the
// thing is not known, kInvalidInput for a text that is not one readable line.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "server/model/approval/standing.h"
#include "storage/store.h"

namespace rigcal::storage {

// Of any edge that is stored, good or failed, counted or not.
[[nodiscard]] Status RetireEdge(Store& store, const EdgeId& id, const Word& word);
[[nodiscard]] Status RestoreEdge(Store& store, const EdgeId& id, const Word& word);

// A closed one; kConflict while it is not. Whether it supersedes others, or is superseded, stays as it is. It is
// restored as what was superseded is: MakeCurrent (standing.h).
[[nodiscard]] Status RetireSession(Store& store, const SessionId& id, const Word& word);

// A sensor of the robot: one that a closed session lists, or an edge that counts names.
[[nodiscard]] Status RetireSensor(Store& store, const RobotId& robot, const SensorId& sensor, const Word& word);
[[nodiscard]] Status RestoreSensor(Store& store, const RobotId& robot, const SensorId& sensor, const Word& word);
[[nodiscard]] Result<bool> HasSensor(Store& store, const RobotId& robot, const SensorId& sensor);

// All of the robot, retired ones too: by name.
[[nodiscard]] Result<std::vector<SensorId>> LoadSensorsOf(Store& store, const RobotId& robot);

// Those that are retired now, with the word by which they are.
[[nodiscard]] Result<std::map<EdgeId, Standing>> LoadRetired(Store& store, const RobotId& robot);
[[nodiscard]] Result<std::map<SessionId, Standing>> LoadRetiredSessions(Store& store, const RobotId& robot);
[[nodiscard]] Result<std::map<SensorId, Standing>> LoadRetiredSensors(Store& store, const RobotId& robot);

// The newest word about it, but for those that begin an epoch; nullopt if nobody said any.
[[nodiscard]] Result<std::optional<Standing>> LoadStanding(Store& store, const EdgeId& id);
[[nodiscard]] Result<std::optional<Standing>> LoadStanding(Store& store, const RobotId& robot, const SensorId& sensor);

}  // namespace rigcal::storage
