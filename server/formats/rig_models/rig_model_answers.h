// The documents of rig models, epochs and fleet statistics (docs/api.md): as those of answers.h.
#pragma once

#include <string>
#include <vector>

#include "server/formats/json/json_writer.h"
#include "server/model/approval/epoch.h"
#include "server/model/robots/population.h"
#include "server/model/robots/rig_model.h"

namespace rigcal::formats {

// verb rig_model: the newest version, what it says, and how many robots are of it.
struct RigModelAnswer {
  RigModelVersion set;
  RigModel model;
  std::int64_t robots = 0;
};
[[nodiscard]] std::string WriteRigModel(const RigModelAnswer& answer);
// verb rig_models: a row of each name that was set or that a session names, sorted. `version` 0: nobody has set it.
struct RigModelRow {
  std::string name;
  std::int64_t version = 0, robots = 0;
};
[[nodiscard]] std::string WriteRigModels(const std::vector<RigModelRow>& rows);
// verb set_rig_model: how many robots wait to be judged anew by it.
[[nodiscard]] std::string WriteRigModelSet(const RigModelVersion& set, std::int64_t robots_waiting);
// Of `rigcal model check`: a file alone.
[[nodiscard]] std::string WriteRigModelCheck(const std::string& file, const RigModel& model);

// verb epoch: of which sensors an epoch began, or was taken back; `standing`: number of the newest word; `has_edges`:
// of the robot, so that a revision follows.
struct EpochAnswer {
  RobotId robot;
  std::vector<SensorId> sensors;
  Stamp begins_at;
  Word word;
  bool taken_back = false;
  std::int64_t standing = 0;
  bool has_edges = false;
};
[[nodiscard]] std::string WriteEpochBegun(const EpochAnswer& answer);
// "epochs": a list of all of a robot, the newest first; nothing where there is none.
void WriteEpochs(JsonWriter& out, const std::vector<Epoch>& epochs);

// verb population. Numbers in m and rad.
[[nodiscard]] std::string WritePopulation(const Population& population);

}  // namespace rigcal::formats
