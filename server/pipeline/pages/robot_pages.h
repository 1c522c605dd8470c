// The pages about one robot that are made when asked for.
#pragma once

#include <string>

#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// `rest` is what follows "/robots/": "<id>/", "<id>/trend.js", "<id>/compare", "<id>/sessions/<id>/",
// "<id>/sessions/<id>/evidence/<digest>.<suffix>". kNotFound for everything else; "<id>/revisions/<n>/...": why it is
// missing.
[[nodiscard]] Result<PageText> AnswerRobotPage(const AnswerContext& context, const std::string& rest,
                                               const std::string& query);

}  // namespace rigcal::pipeline
