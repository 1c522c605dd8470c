#include "server/http/forwarded.h"

#include <algorithm>
#include <atomic>

#include "server/base/limits_in_force.h"
#include "server/base/log.h"
#include "server/http/error_body.h"
#include "server/http/guarded.h"
#include "server/http/reply.h"
#include "server/http/site.h"

namespace rigcal::http {
namespace {

constexpr std::string_view kForward = "/api/v1/forward", kSiteBearer = "Bearer ";
constexpr std::size_t kReadAtOnce = 16 << 10;  // the time that a request may take is that of such a piece

// Half of the threads at most: whatever sites send, and however slowly, the others are for everybody else.
class Turn {
 public:
  Turn() : is_given_(++taken() <= std::max<std::int64_t>(1, limits::InForce().http_connections / 2)) {}
  ~Turn() { --taken(); }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  [[nodiscard]] bool is_given() const { return is_given_; }

 private:
  static std::atomic<std::int64_t>& taken() {
    static std::atomic<std::int64_t> taken = 0;
    return taken;
  }
  const bool is_given_;
};

bool IsForward(const std::string& path) {
  return path.rfind(kForward, 0) == 0 && (path.size() == kForward.size() || path[kForward.size()] == '/');
}

int Refuse(mg_connection* connection, int status, const Error& error, const Headers& headers = {}) {
  return SendError(connection, status, error, true, headers);
}

Result<std::optional<Person>> WhoSends(const mg_connection* connection, const Logins& logins) {
  const std::string_view given = HeaderOf(connection, "Authorization");
  if (given.substr(0, kSiteBearer.size()) != kSiteBearer || !logins.of_token) return std::optional<Person>();
  return logins.of_token(std::string(given.substr(kSiteBearer.size())));
}

// Reads on where the one before ended.
class Body {
 public:
  Body(mg_connection* connection, std::int64_t size_bytes) : connection_(connection), left_bytes_(size_bytes) {}
  Result<std::string> Next(std::size_t bytes_max) {
    std::string bytes(
        static_cast<std::size_t>(std::min<std::int64_t>(left_bytes_, static_cast<std::int64_t>(bytes_max))), '\0');
    for (std::size_t got = 0; got < bytes.size();) {
      const int more = mg_read(connection_, bytes.data() + got, std::min(kReadAtOnce, bytes.size() - got));
      if (more <= 0) return Fail(ErrorCode::kBusy, "the request's body did not come whole", "Send it again");
      got += static_cast<std::size_t>(more);
    }
    left_bytes_ -= static_cast<std::int64_t>(bytes.size());
    return bytes;
  }

 private:
  mg_connection* connection_;
  std::int64_t left_bytes_;
};

int StatusForSite(ErrorCode code) {
  if (code == ErrorCode::kConflict || code == ErrorCode::kUnsupported) return 409;
  return StatusOf(code);
}

int AnswerTheSite(mg_connection* connection, const std::string& path, const Person& site) {
  const mg_request_info* request = mg_get_request_info(connection);
  const bool has_body = request->content_length > 0;
  if (mg_get_header(connection, "Transfer-Encoding") != nullptr)
    return Refuse(connection, 411,
                  {ErrorCode::kInvalidInput, "the request does not say how long its body is", "Send `Content-Length`"});
  const Turn turn;
  if (!turn.is_given())
    return Refuse(connection, 503,
                  {ErrorCode::kBusy, "the sites send more at once than this server takes", "Send less at once."},
                  {{"Retry-After", "1"}});
  NoteHeard(connection);  // whoever has this token may take its time
  Body body(connection, has_body ? request->content_length : 0);
  const SiteRequest asked{site,
                          request->request_method,
                          path.substr(kForward.size()),
                          has_body ? static_cast<std::int64_t>(request->content_length) : 0,
                          [&](std::size_t bytes_max) { return body.Next(bytes_max); },
                          request->query_string == nullptr ? "" : request->query_string};
  const auto done = Guarded(path, [&] { return SiteOf(connection).answer_site(asked); });
  if (done) return SendOnce(connection, 200, *done, "application/json; charset=utf-8");
  if (done.error().code == ErrorCode::kInvalidInput || done.error().code == ErrorCode::kConflict)
    LogWarn("the site " + site.name + " was refused: " + Sentence(done.error()));
  return Refuse(connection, StatusForSite(done.error().code), done.error());
}

}  // namespace

std::optional<int> AnswerForwarded(mg_connection* connection, const std::string& path) {
  const Site& here = SiteOf(connection);
  if (!here.answer_site || !IsForward(path)) return std::nullopt;
  const auto person = Guarded("who sends", [&] { return WhoSends(connection, here.logins); });
  if (!person) return Refuse(connection, 503, person.error());
  if (!*person)
    return Refuse(connection, 401,
                  {ErrorCode::kInvalidInput, "this takes the token of a site, and none that is good was sent",
                   "Make one at the centre: `rigcal token new NAME --role site`"},
                  {{"WWW-Authenticate", "Bearer realm=\"rigcal\""}});
  if (!(*person)->is_site())
    return Refuse(connection, 403,
                  {ErrorCode::kInvalidInput,
                   "this takes the token of a site, and " + (*person)->name + " is " + NameOf((*person)->role),
                   "Make one at the centre: `rigcal token new NAME --role site`"});
  return AnswerTheSite(connection, path, **person);
}

}  // namespace rigcal::http
