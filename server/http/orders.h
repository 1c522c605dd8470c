// Orders of people and programs: POST /api/v1/<order>, a JSON object as its body.
#pragma once

#include <civetweb.h>

#include <optional>
#include <string>

#include "server/http/logins/entrance.h"

namespace rigcal::http {

// Where it is an order, and logins are needed: the status of its answer; nothing: it is none. Refused with 403 is
// whoever may not give it, and a browser that does not send the token of its login page as `X-Rigcal-Form` and its own
// page as Origin.
[[nodiscard]] std::optional<int> AnswerOrder(mg_connection* connection, const std::string& path, const Visit& visit);

}  // namespace rigcal::http
