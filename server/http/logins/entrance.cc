#include "server/http/logins/entrance.h"

#include "server/http/guarded.h"
#include "server/http/logins/form.h"
#include "server/http/logins/login_acts.h"
#include "server/http/pages/html_text.h"
#include "server/http/reply.h"
#include "server/http/request_path.h"
#include "server/http/site.h"

namespace rigcal::http {
namespace {

constexpr std::string_view kBearer = "Bearer ";

bool HasToken(const mg_connection* connection) {
  return HeaderOf(connection, "Authorization").substr(0, kBearer.size()) == kBearer;
}

Result<std::optional<Person>> WhoIs(const mg_connection* connection, const Logins& logins) {
  if (HasToken(connection))
    return logins.of_token(std::string(HeaderOf(connection, "Authorization").substr(kBearer.size())));
  const std::string secret = SessionSecretOf(connection);
  return secret.empty() ? std::optional<Person>() : logins.of_session(secret);
}

std::string AskedFor(const mg_connection* connection, const std::string& path) {
  const char* const query = mg_get_request_info(connection)->query_string;
  return query != nullptr && *query != 0 ? path + "?" + query : path;
}

// A browser that follows a link of another site leaves the cookie out (SameSite=Strict); from a page of ours it does
// not.
int SendFromHere(mg_connection* connection, const std::string& path, const std::string& wanted) {
  return SendOnce(connection, 200,
                  PageAround("Rigcal", "<section class=\"card empty\"><p class=\"what\"><a href=\"" + Escaped(wanted) +
                                           "\">Go on to this page</a></p></section>"),
                  "text/html; charset=utf-8",
                  {{"Refresh", "0; url=" + PercentEncoded(path) + wanted.substr(path.size())}});
}

bool IsRead(const mg_connection* connection) {
  return IsHead(connection) || std::string_view(mg_get_request_info(connection)->request_method) == "GET";
}

int SendStranger(mg_connection* connection, const std::string& path) {
  const bool takes_page = HeaderOf(connection, "Accept").find("text/html") != std::string_view::npos;
  const std::string wanted = AskedFor(connection, path);
  if (takes_page && IsRead(connection) && !HasToken(connection)) {
    if (HeaderOf(connection, "Sec-Fetch-Site") == "cross-site") return SendFromHere(connection, path, wanted);
    return SendRedirect(connection, 303, "/login?next=" + PercentEncoded(wanted));
  }
  return SendError(
      connection, 401,
      {ErrorCode::kInvalidInput, HasToken(connection) ? "this token is not good, or no longer" : "this needs a login",
       "People log in at /login; programs send `Authorization: Bearer TOKEN` (`rigcal token new`)"},
      IsApi(path) || path == "/metrics", {{"WWW-Authenticate", "Bearer realm=\"rigcal\""}});
}

int SendToSite(mg_connection* connection, const std::string& path, const Person& site) {
  return SendError(connection, 403,
                   {ErrorCode::kInvalidInput, "the token of the site " + site.name + " reads nothing here",
                    "Programs that read take a token of another role: `rigcal token new`"},
                   IsApi(path));
}

}  // namespace

Result<bool> AreLoginsNeeded(const Logins& logins) {
  return logins.are_needed ? Guarded("whether a login is needed", logins.are_needed) : false;
}

bool IsForEverybody(const std::string& path) { return path == "/healthz" || path == "/readyz" || path == "/style.css"; }

std::optional<int> Admit(mg_connection* connection, const std::string& path, Visit& visit) {
  if (IsForEverybody(path)) return std::nullopt;
  const auto person = Guarded("who asks", [&] { return WhoIs(connection, SiteOf(connection).logins); });
  if (!person) return SendError(connection, 503, person.error(), IsApi(path));
  visit.person = *person;
  visit.is_program = HasToken(connection);
  if (path == "/login") return AnswerLogin(connection, visit);
  if (path == "/logout") return AnswerLogout(connection, visit);
  if (visit.person && visit.person->is_site()) return SendToSite(connection, path, *visit.person);
  if (visit.person) return std::nullopt;
  return SendStranger(connection, path);
}

void SetVisit(mg_connection* connection, const Visit* visit) {
  mg_set_user_connection_data(connection, const_cast<Visit*>(visit));
}

const Visit* VisitOf(const mg_connection* connection) {
  return static_cast<const Visit*>(mg_get_user_connection_data(connection));
}

}  // namespace rigcal::http
