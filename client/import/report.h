// What was found in a bag, and what became of it, for people and as JSON.
#pragma once

#include <ostream>
#include <string>

#include "client/import/import.h"
#include "client/import/survey.h"

namespace rigcal::importing {

// A table of topics, and below it what has to be known of their clocks, gaps and messages that cannot be decoded.
void PrintSurvey(const BagSurvey& survey, std::ostream& out);
[[nodiscard]] std::string SurveyJson(const BagSurvey& survey);

// Captures, and of each sensor what was written, what was not, and why.
void PrintOutcome(const ImportOutcome& outcome, const std::string& folder, std::ostream& out);
[[nodiscard]] std::string OutcomeJson(const ImportOutcome& outcome, const std::string& folder);
// What OutcomeJson wrote, without its folder; anything else is kInvalidInput.
[[nodiscard]] Result<ImportOutcome> ReadOutcome(const std::string& text);

}  // namespace rigcal::importing
