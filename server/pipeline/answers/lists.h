// READ: the verbs that list what is stored, whole or by pages.
#pragma once

#include <string>
#include <vector>

#include "server/formats/answers/parameters.h"
#include "server/model/robots/fleet_list.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// sessions, edges, revisions: a robot's history. audit, audit_verify: who decided what, and whether all of it is as it
// was written. due_ics: by when robots are due. webhooks: who is told of changes by HTTP, and what waits for them. A
// page costs what it holds, however long the history is; audit_verify reads all of it.
[[nodiscard]] std::vector<VerbAnswer> ListVerbs();

// By when robots are due.
struct DueCalendar {
  std::string text;               // RFC 5545
  std::int64_t without_date = 0;  // robots that were never calibrated: they are in no calendar
};
// Of all robots, or of those of one site (parameter `site`); by id. kNotFound where no robot is at that site.
[[nodiscard]] Result<DueCalendar> MakeDueCalendar(const AnswerContext& context, const formats::Parameters& parameters);

// For /metrics: how many robots have which status, and what waits for which receiver.
[[nodiscard]] Result<std::vector<metrics::Reading>> AlertReadings(storage::Store& store, const FleetCounts& fleet);

}  // namespace rigcal::pipeline
