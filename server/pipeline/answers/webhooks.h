// READ: who is told of changes by HTTP, and what waits for them.
#pragma once

#include <string>
#include <vector>

#include "server/formats/answers/parameters.h"
#include "server/model/robots/fleet_list.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// Verb webhooks.
[[nodiscard]] Result<std::string> ListWebhooks(const AnswerContext& context, const formats::Parameters& parameters);
// For /metrics: how many robots have which status, and what waits for which receiver.
[[nodiscard]] Result<std::vector<metrics::Reading>> AlertReadings(storage::Store& store, const FleetCounts& fleet);

}  // namespace rigcal::pipeline
