// The limits that people set. Append-only: of each scope and subject the newest holds. Setting one lets the robots that
// it is for wait to be judged anew.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/model/approval/policy_version.h"
#include "storage/store.h"

namespace rigcal::storage {

// The next version for this place, noted in the audit; the newest as it is, and no change, where it has that text.
// kInvalidInput where a text of `word` is none (standing.h).
[[nodiscard]] Result<PolicyVersion> AppendPolicy(Store& store, const PolicyPlace& place, const std::string& text,
                                                 const Word& word);
[[nodiscard]] Result<std::optional<PolicyVersion>> LoadPolicy(Store& store, const PolicyPlace& place);
// Number of the newest of all; 0: none was set.
[[nodiscard]] Result<std::int64_t> LoadPolicyWatermark(Store& store);

// As the robot's newest closed session says; empty: none does.
[[nodiscard]] Result<std::string> LoadRigModel(Store& store, const RobotId& robot);

// Whether a closed session names it.
[[nodiscard]] Result<bool> HasRigModel(Store& store, const std::string& model);
// Those that closed sessions name, sorted, at most `max`.
[[nodiscard]] Result<std::vector<std::string>> LoadRigModels(Store& store, int max);

// Robots of which a newer policy, or rig model (rig_models.h), than that of their newest revision was set, or whose
// merged edges are to be made anew (merged_edges.h), after `after` by id, at most `max` of them.
[[nodiscard]] Result<std::vector<RobotId>> LoadRobotsToJudge(Store& store, const RobotId& after, int max);
// How many of them wait for the policy of this number.
[[nodiscard]] Result<std::int64_t> CountRobotsToJudge(Store& store, std::int64_t policy_number);

}  // namespace rigcal::storage
