#include "server/http/logins/request_body.h"

#include "server/http/reply.h"
#include "server/http/site.h"

namespace rigcal::http {
namespace {

tl::unexpected<Refusal> Refused(int status, const std::string& what, const std::string& cure) {
  return tl::unexpected<Refusal>({status, {ErrorCode::kInvalidInput, what, cure}});
}

}  // namespace

tl::expected<std::string, Refusal> ReadBody(mg_connection* connection, const std::string& type, std::size_t bytes_max) {
  const long long length = mg_get_request_info(connection)->content_length;
  if (length < 0 || mg_get_header(connection, "Transfer-Encoding") != nullptr)
    return Refused(411, "the request does not say how long its body is", "Send `Content-Length`");
  if (length > static_cast<long long>(bytes_max))
    return Refused(413, "the request's body is larger than " + std::to_string(bytes_max) + " bytes", "Send less");
  const std::string_view given = HeaderOf(connection, "Content-Type");
  if (given.substr(0, given.find(';')) != type)
    return Refused(415, "the request's body is not " + type, "Send `Content-Type: " + type + "`");
  std::string body(static_cast<std::size_t>(length), '\0');
  const int got = length == 0 ? 0 : mg_read(connection, body.data(), body.size());
  NoteHeard(connection);
  if (got == static_cast<int>(length)) return body;
  return Refused(400, "the request's body did not come whole", "Send it again");
}

}  // namespace rigcal::http
