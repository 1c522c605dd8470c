// What servers of sites send on: asked and answered below /api/v1/forward, with a token of theirs and nobody else's.
#pragma once

#include <civetweb.h>

#include <optional>
#include <string>

namespace rigcal::http {

// Answers what is below /api/v1/forward, whether or not others need a login; `path` as NormalPath() gives it. The
// status; nothing: it is about something else.
[[nodiscard]] std::optional<int> AnswerForwarded(mg_connection* connection, const std::string& path);

}  // namespace rigcal::http
