// READ: the one thing that an order is about.
#pragma once

#include <string>
#include <variant>

#include "server/base/ids.h"
#include "server/formats/answers/parameters.h"
#include "storage/store.h"

namespace rigcal::pipeline {

struct SensorOfRobot {
  RobotId robot;
  SensorId sensor;
};
using Subject = std::variant<EdgeId, SessionId, SensorOfRobot>;

// Who decides, in the parameter `who`: kInvalidInput also of a name that is no person's (CheckPerson).
[[nodiscard]] Result<std::string> RequiredWho(const formats::Parameters& parameters, const std::string& cure);
// kInvalidInput, with `cure`, where the parameter is missing or blank.
[[nodiscard]] Result<std::string> RequiredText(const formats::Parameters& parameters, const std::string& name,
                                               const std::string& cure);

// `edge` or `session`: an id or its first 8 digits or more, of `robot` if that is there. `sensor`: of `robot`. `thing`:
// any of these, whichever there is; a sensor of that very name comes first. kNotFound, kConflict (several begin so),
// kInvalidInput name what is wrong.
[[nodiscard]] Result<Subject> FindSubject(storage::Store& store, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
