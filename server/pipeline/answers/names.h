// The verbs that tell names, for command lines that are being typed and for pushes in the name of a new robot.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// The documents of docs/api.md, up to kPageRowsMax names at once.
[[nodiscard]] Result<std::string> TellRobotNames(const AnswerContext& context, const formats::Parameters& parameters);
[[nodiscard]] Result<std::string> TellSensorNames(const AnswerContext& context, const formats::Parameters& parameters);
// Whether a robot is known, and if not, of which known ones its name is a slip.
[[nodiscard]] Result<std::string> TellKnownRobot(const AnswerContext& context, const formats::Parameters& parameters);

// Whether another robot's session holds these files: of which session, and how many.
[[nodiscard]] Result<std::string> TellKnownFiles(const AnswerContext& context, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
