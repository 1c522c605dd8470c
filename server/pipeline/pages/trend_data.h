// The history of a robot's sensors, as its page draws it: over revisions, and over visits.
#pragma once

#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// /robots/<id>/trend.js (report/robot_pages.h, TrendData): of the newest revisions, as many as stay within bounds, and
// of the newest visits that count.
[[nodiscard]] Result<PageText> AnswerTrend(const AnswerContext& context, const RobotId& robot);

}  // namespace rigcal::pipeline
