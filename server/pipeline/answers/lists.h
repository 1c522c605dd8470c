// The verbs that list what a robot's history holds, whole or by pages.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// The documents of docs/api.md. A page costs what it holds, however long the history is.
[[nodiscard]] Result<std::string> ListSessions(const AnswerContext& context, const formats::Parameters& parameters);
[[nodiscard]] Result<std::string> ListEdges(const AnswerContext& context, const formats::Parameters& parameters);
[[nodiscard]] Result<std::string> ListRevisions(const AnswerContext& context, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
