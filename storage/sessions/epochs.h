// When epochs of sensors began (approval/epoch.h): by what sessions say, by the parts that they name, by what people
// say. Append-only; what was measured stays as it is.
#pragma once

#include <optional>
#include <vector>

#include "server/model/approval/epoch.h"
#include "storage/store.h"

namespace rigcal::storage {

// All that count, the earliest first. Sessions count unless they are superseded; of what a session tells of its parts
// also unless it is retired. Another part: a serial number, or firmware, that differs from what the session captured
// last before it told of the sensor; what was not told differs from nothing. Call it inside one Read, so that all are
// of one moment.
[[nodiscard]] Result<std::vector<Epoch>> LoadEpochs(Store& store, const RobotId& robot);

// By a person: of these sensors from `begins_at` on. Of a sensor whose newest epoch by a person began then, by the same
// word, a no-op. Noted in the audit. kInvalidInput where a text of `word` is none (standing.h), or it begins after
// `word.at`.
[[nodiscard]] Status BeginEpoch(Store& store, const RobotId& robot, const std::vector<SensorId>& sensors,
                                Stamp begins_at, const Word& word);
// Of each of these sensors the newest that a person began and nobody took back. Which: sensors of which there is none
// are passed over.
[[nodiscard]] Result<std::vector<Epoch>> TakeBackEpoch(Store& store, const RobotId& robot,
                                                       const std::vector<SensorId>& sensors, const Word& word);

}  // namespace rigcal::storage
