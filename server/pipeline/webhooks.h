// READ: who is told of changes by HTTP, and what waits for them.
#pragma once

#include <string>

#include "server/formats/parameters.h"
#include "server/model/fleet_list.h"
#include "server/pipeline/answer.h"

namespace rigcal::pipeline {

// Verb webhooks.
[[nodiscard]] Result<std::string> ListWebhooks(const AnswerContext& context, const formats::Parameters& parameters);
// The lines of /metrics: how many robots have which status, and what waits for which receiver.
[[nodiscard]] Result<std::string> AlertMetrics(storage::Store& store, const FleetCounts& fleet);

}  // namespace rigcal::pipeline
