// Rig models that people set (robots/rig_model.h). Append-only: of each name the newest version holds. Setting one lets
// the robots of that model wait to be judged anew.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/robots/rig_model.h"
#include "storage/store.h"

namespace rigcal::storage {

// The next version of this name, noted in the audit; the newest as it is, and no change, where it has that text.
// kInvalidInput where a text of `word` is none (standing.h).
[[nodiscard]] Result<RigModelVersion> AppendRigModel(Store& store, const std::string& name, const std::string& text,
                                                     const Word& word);
[[nodiscard]] Result<std::optional<RigModelVersion>> LoadRigModelVersion(Store& store, const std::string& name);
// Number of the newest of all; 0: none was set.
[[nodiscard]] Result<std::int64_t> LoadRigModelWatermark(Store& store);
// Of each name the newest version, by name, up to `max`.
[[nodiscard]] Result<std::vector<RigModelVersion>> LoadRigModelVersions(Store& store, int max);

// How many robots wait to be judged by the version of this number.
[[nodiscard]] Result<std::int64_t> CountRobotsOfModelToJudge(Store& store, std::int64_t rig_model_number);
// Robots whose newest closed session is of this rig model, by id, up to `max`.
[[nodiscard]] Result<std::vector<RobotId>> LoadRobotsOfModel(Store& store, const std::string& name, int max);

}  // namespace rigcal::storage
