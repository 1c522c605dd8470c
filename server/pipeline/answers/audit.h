// READ: who decided what, and whether all of it is as it was written.
#pragma once

#include <string>

#include "server/formats/answers/parameters.h"
#include "server/pipeline/answers/answer.h"

namespace rigcal::pipeline {

// The documents of docs/api.md. A page of the audit costs what it holds, of one robot too.
[[nodiscard]] Result<std::string> ListAudit(const AnswerContext& context, const formats::Parameters& parameters);
// Reads all of it.
[[nodiscard]] Result<std::string> VerifyAudit(const AnswerContext& context, const formats::Parameters& parameters);

}  // namespace rigcal::pipeline
