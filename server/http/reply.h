// Writes answers: status, the headers that every answer carries, body (none for HEAD).
#pragma once

#include <civetweb.h>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/base/result.h"

namespace rigcal::http {

using Headers = std::vector<std::pair<std::string, std::string>>;

// Status line, security headers, Content-Length, then `headers`.
void SendHead(mg_connection* connection, int status, std::int64_t body_bytes, const Headers& headers);
// False once the client has gone or stopped taking.
[[nodiscard]] bool SendBytes(mg_connection* connection, std::string_view bytes);
// What never changes is kept by the browser; the rest is asked for again, with its tag.
[[nodiscard]] const char* CacheControlOf(bool immutable);
// An answer of `headers` (with its Content-Type) compressed, or 304, where the client takes gzip and it is worth it:
// its status. Else nothing is sent, and `headers` have gained Vary where it would be. `tag`, without quotes, names the
// body that `read` gives.
[[nodiscard]] std::optional<int> SendCompressed(mg_connection* connection, const std::string& tag,
                                                std::size_t size_bytes, Headers& headers,
                                                const std::function<std::string()>& read);
// Head and body, compressed where that is worth it, with the notice of an open server, or of who is logged in, in
// pages; 304 if the client has this very body.
int SendBody(mg_connection* connection, const std::string& body, const std::string& content_type,
             bool immutable = false);
// Kept by nobody.
int SendOnce(mg_connection* connection, int status, const std::string& body, const std::string& content_type,
             const Headers& headers = {});
int SendRedirect(mg_connection* connection, int status, const std::string& location);
// A small page, or below /api the document {"error": {code, cure, what}}. Returns the status.
int SendError(mg_connection* connection, int status, const Error& error, bool as_json, const Headers& headers = {});

// Whether anybody on the network can read what is asked for, so that pages say it.
[[nodiscard]] bool IsOpenTo(const mg_connection* connection);
[[nodiscard]] bool IsHead(const mg_connection* connection);  // then the answer has no body
[[nodiscard]] std::string_view HeaderOf(const mg_connection* connection, const char* name);  // "" if absent

}  // namespace rigcal::http
