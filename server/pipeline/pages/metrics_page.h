// READ: /metrics, what programs watch (docs/metrics.md).
#pragma once

#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// What happened since the start, what the store and the server's parts say now, and `context.more_readings`.
[[nodiscard]] Result<PageText> AnswerMetrics(const AnswerContext& context);

}  // namespace rigcal::pipeline
