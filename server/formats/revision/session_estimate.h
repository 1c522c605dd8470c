// The stored document of a session's joint refinement.
#pragma once

#include <string>

#include "server/base/result.h"
#include "server/model/sessions/session_estimate.h"

namespace rigcal::formats {

// Canonical, as all documents (documents.h). Reading refuses by name what is not one.
[[nodiscard]] std::string WriteSessionEstimate(const SessionEstimate& estimate);
[[nodiscard]] Result<SessionEstimate> ReadSessionEstimate(std::string_view text);

}  // namespace rigcal::formats
