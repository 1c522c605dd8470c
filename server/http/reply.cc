#include "server/http/reply.h"

#include <algorithm>
#include <cstring>

#include "server/base/digests/sha256.h"
#include "server/http/conditions.h"
#include "server/http/error_body.h"
#include "server/http/logins/entrance.h"
#include "server/http/pages/login_page.h"
#include "server/http/pages/open_notice.h"
#include "server/http/request_path.h"
#include "server/http/site.h"

namespace rigcal::http {
namespace {

// The pages need nothing from elsewhere, and their scripts and styles are files: so nothing else is allowed.
constexpr const char* kContentPolicy =
    "default-src 'none'; style-src 'self'; img-src 'self' data:; script-src 'self'; connect-src 'self'; "
    "font-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

void Add(mg_connection* connection, const char* name, const std::string& value) {
  mg_response_header_add(connection, name, value.c_str(), static_cast<int>(value.size()));
}

// Not by the name localhost: browsers would keep to it for every other server of their own machine.
bool IsOverTlsOnly(const mg_connection* connection) {
  const std::string_view host = HeaderOf(connection, "Host");
  return SiteOf(connection).certificate && host.substr(0, host.find(':')) != "localhost";
}

}  // namespace

bool IsHead(const mg_connection* connection) {
  const char* method = mg_get_request_info(connection)->request_method;
  return method && std::strcmp(method, "HEAD") == 0;
}

std::string_view HeaderOf(const mg_connection* connection, const char* name) {
  const char* value = mg_get_header(connection, name);
  return value ? std::string_view(value) : std::string_view();
}

void SendHead(mg_connection* connection, int status, std::int64_t body_bytes, const Headers& headers) {
  mg_response_header_start(connection, status);
  Add(connection, "Content-Security-Policy", kContentPolicy);
  Add(connection, "X-Content-Type-Options", "nosniff");
  const bool has_own =
      std::any_of(headers.begin(), headers.end(), [](const auto& one) { return one.first == "Referrer-Policy"; });
  if (!has_own) Add(connection, "Referrer-Policy", "no-referrer");
  Add(connection, "Cross-Origin-Resource-Policy", "same-origin");
  if (IsOverTlsOnly(connection)) Add(connection, "Strict-Transport-Security", "max-age=2592000");
  if (status != 304) Add(connection, "Content-Length", std::to_string(body_bytes));
  for (const auto& [name, value] : headers) Add(connection, name.c_str(), value);
  mg_response_header_send(connection);
}

bool SendBytes(mg_connection* connection, std::string_view bytes) {
  constexpr std::size_t kPieceBytes = 64 << 10;
  while (!bytes.empty()) {
    const std::string_view piece = bytes.substr(0, kPieceBytes);
    if (mg_write(connection, piece.data(), piece.size()) != static_cast<int>(piece.size())) return false;
    bytes.remove_prefix(piece.size());
  }
  return true;
}

const char* CacheControlOf(bool immutable) { return immutable ? "private, max-age=31536000, immutable" : "no-cache"; }

namespace {

int SendWhole(mg_connection* connection, std::string_view body, const Headers& headers) {
  SendHead(connection, 200, static_cast<std::int64_t>(body.size()), headers);
  if (!IsHead(connection)) (void)SendBytes(connection, body);
  return 200;
}

std::string ForReaders(const mg_connection* connection, const std::string& given, const std::string& content_type) {
  if (!IsPage(content_type)) return given;
  const std::string& note = SiteOf(connection).note;
  const std::string body = note.empty() ? given : WithNotice(given, NoteOf(note));
  if (IsOpenTo(connection)) return WithOpenNotice(body);
  const Visit* const visit = VisitOf(connection);
  return visit != nullptr && visit->person && !visit->is_program ? WithNotice(body, PersonNotice(*visit->person))
                                                                 : body;
}

}  // namespace

bool IsOpenTo(const mg_connection* connection) {
  const Site& site = SiteOf(connection);
  const Visit* const visit = VisitOf(connection);
  return site.is_open && (visit != nullptr ? !visit->needs_login : !site.logins.are_needed);
}

// A tag names the very bytes: those of gzip have one of their own.
std::optional<int> SendCompressed(mg_connection* connection, const std::string& tag, std::size_t size_bytes,
                                  Headers& headers, const std::function<std::string()>& read) {
  const auto type =
      std::find_if(headers.begin(), headers.end(), [](const auto& one) { return one.first == "Content-Type"; });
  if (type == headers.end() || !IsWorthCompressing(type->second, size_bytes)) return std::nullopt;
  headers.emplace_back("Vary", "Accept-Encoding");
  if (!AcceptsGzip(HeaderOf(connection, "Accept-Encoding"))) return std::nullopt;
  Headers packed = headers;
  packed.emplace_back("ETag", "\"" + tag + "-gz\"");
  if (MatchesTag(HeaderOf(connection, "If-None-Match"), packed.back().second)) {
    SendHead(connection, 304, 0, packed);
    return 304;
  }
  const auto gzip = SiteOf(connection).compressed->Of(tag, read);
  if (!gzip) return std::nullopt;
  packed.emplace_back("Content-Encoding", "gzip");
  return SendWhole(connection, *gzip, packed);
}

int SendBody(mg_connection* connection, const std::string& given, const std::string& content_type, bool immutable) {
  const std::string body = ForReaders(connection, given, content_type);
  const std::string tag = Sha256Of(body).str().substr(0, 32);
  Headers headers = {{"Cache-Control", CacheControlOf(immutable)}, {"Content-Type", content_type}};
  if (const auto status = SendCompressed(connection, tag, body.size(), headers, [&body] { return body; }))
    return *status;
  headers.emplace_back("ETag", "\"" + tag + "\"");
  if (!MatchesTag(HeaderOf(connection, "If-None-Match"), headers.back().second))
    return SendWhole(connection, body, headers);
  SendHead(connection, 304, 0, headers);
  return 304;
}

int SendRedirect(mg_connection* connection, int status, const std::string& location) {
  SendHead(connection, status, 0, {{"Location", location}, {"Cache-Control", "no-cache"}});
  return status;
}

namespace {

std::string RobotOf(const mg_connection* connection) {
  const mg_request_info* request = mg_get_request_info(connection);
  if (!request || !request->local_uri_raw) return "";
  const auto path = NormalPath(request->local_uri_raw);
  return path ? RobotAbove(*path) : "";
}

}  // namespace

int SendOnce(mg_connection* connection, int status, const std::string& given, const std::string& content_type,
             const Headers& headers) {
  const std::string body = ForReaders(connection, given, content_type);
  Headers all = {{"Content-Type", content_type}, {"Cache-Control", "no-store"}};
  all.insert(all.end(), headers.begin(), headers.end());
  SendHead(connection, status, static_cast<std::int64_t>(body.size()), all);
  if (!IsHead(connection)) (void)SendBytes(connection, body);
  return status;
}

int SendError(mg_connection* connection, int status, const Error& error, bool as_json, const Headers& headers) {
  const std::string body = as_json ? ErrorDocument(error) : ErrorPage(status, error, RobotOf(connection));
  return SendOnce(connection, status, body, as_json ? "application/json; charset=utf-8" : "text/html; charset=utf-8",
                  headers);
}

}  // namespace rigcal::http
