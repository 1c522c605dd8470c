// What was found and judged, for people and as JSON.
#pragma once

#include <ostream>
#include <string>

#include "client/check/advice.h"

namespace rigcal::check {

// The verdict with its advice and remarks, and by which limits it judges, then tables of cameras, lidars, streams and
// pairs. What a push refuses is counted, not told.
void PrintReport(const Findings& findings, const Judgement& judgement, std::ostream& out);
// One object: docs/api.md, check.
[[nodiscard]] std::string ReportJson(const Findings& findings, const Judgement& judgement);

}  // namespace rigcal::check
