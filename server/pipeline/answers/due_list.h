// READ: by when robots are due, as a calendar.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

struct DueCalendar {
  std::string text;               // RFC 5545
  std::int64_t without_date = 0;  // robots that were never calibrated: they are in no calendar
};
// Of all robots, or of those of one site (parameter `site`); by id. kNotFound where no robot is at that site.
[[nodiscard]] Result<DueCalendar> MakeDueCalendar(const AnswerContext& context, const formats::Parameters& parameters);
// Verb due_ics: the same as a document.
[[nodiscard]] Result<std::string> TellDueCalendar(const AnswerContext& context, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
