// The pages about rig models, made when asked for.
#pragma once

#include <string>

#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// `rest` is what follows "/models/": "" is the list, "NAME/" the page of one. kNotFound for everything else.
[[nodiscard]] Result<PageText> AnswerModelPage(const AnswerContext& context, const std::string& rest);

}  // namespace rigcal::pipeline
