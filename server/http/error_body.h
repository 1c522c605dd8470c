// What a failed request is answered with. Pure.
#pragma once

#include <string>

#include "server/base/result.h"

namespace rigcal::http {

[[nodiscard]] int StatusOf(ErrorCode code);                   // kNotFound 404, kInvalidInput 400, else 503
[[nodiscard]] std::string ErrorDocument(const Error& error);  // {"error": {code, cure, what}}
// HTML, escaped; `in backticks` becomes code. With a way on: to the fleet, and to `robot` if it is not empty.
[[nodiscard]] std::string ErrorPage(int status, const Error& error, const std::string& robot = "");

}  // namespace rigcal::http
