// What a failed request is answered with. Pure.
#pragma once

#include <string>

#include "server/base/result.h"

namespace rigcal::http {

[[nodiscard]] int StatusOf(ErrorCode code);                           // kNotFound 404, kInvalidInput 400, else 503
[[nodiscard]] std::string ErrorDocument(const Error& error);          // {"error": {code, cure, what}}
[[nodiscard]] std::string ErrorPage(int status, const Error& error);  // HTML, escaped

}  // namespace rigcal::http
