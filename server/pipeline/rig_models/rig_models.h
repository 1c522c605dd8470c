// Rig models: which holds for a robot, what is told of them, how they are set.
#pragma once

#include <string>
#include <vector>

#include "server/base/stamp.h"
#include "server/formats/answers/parameters.h"
#include "server/formats/rig_models/rig_model_answers.h"
#include "server/model/approval/order.h"
#include "server/model/robots/rig_model.h"
#include "storage/store.h"

namespace rigcal::pipeline {

// READ: the newest version of this name; without a name of the model where nobody has set it. Call within
// one Read, so that model and watermark are of one moment.
[[nodiscard]] Result<ExpectedRig> LoadExpectedRig(storage::Store& store, const std::string& rig_model);

// READ: what the rig model of a session has and the session does not list, as a sentence; empty: nothing. Nobody asks
// for sensors that were retired from the robot.
[[nodiscard]] Result<std::string> LoadLacking(storage::Store& store, const RobotId& robot, const SessionHeader& header);

// Verb rig_model: `model`. kNotFound where nobody has set it.
[[nodiscard]] Result<std::string> TellRigModel(storage::Store& store, const formats::Parameters& parameters);
// Those that were set or that sessions name, up to kRigModelsMax of either, sorted; and as verb rig_models.
[[nodiscard]] Result<std::vector<formats::RigModelRow>> LoadRigModelRows(storage::Store& store);
[[nodiscard]] Result<std::string> ListRigModels(storage::Store& store);
inline constexpr int kRigModelsMax = 1000;
inline constexpr int kRobotsOfModelMax = 100'000;

// Order set_rig_model: `text` (YAML, which names the model), `who`, `reason`. Robots of the model wait to be judged
// anew. kNotFound where no session is of it, unless `new_model` says that its sessions are to come.
[[nodiscard]] Result<OrderDone> SetRigModel(storage::Store& store, const Clock& clock,
                                            const formats::Parameters& parameters);

// The parameter `model`: one line that a session may name.
[[nodiscard]] Result<std::string> RequiredRigModel(const formats::Parameters& parameters);
// kNotFound where nobody has set it and no session names it: what may be meant. `cure`: of who cannot say that it is a
// new one.
inline constexpr const char* kListRigModels = "`rigcal model list` lists those that are known.";
[[nodiscard]] Status CheckRigModelKnown(storage::Store& store, const std::string& model, const char* cure = nullptr);

}  // namespace rigcal::pipeline
