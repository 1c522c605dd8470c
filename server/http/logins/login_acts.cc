#include "server/http/logins/login_acts.h"

#include <chrono>

#include "server/base/digests/hmac.h"
#include "server/base/digests/secret.h"
#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/base/text.h"
#include "server/http/connections/client_address.h"
#include "server/http/guarded.h"
#include "server/http/logins/form.h"
#include "server/http/logins/request_body.h"
#include "server/http/pages/login_page.h"
#include "server/http/reply.h"
#include "server/http/site.h"

namespace rigcal::http {
namespace {

constexpr std::size_t kSecretBytes = 64;
constexpr std::size_t kLoginBytesMax = 8 << 10;

// Servers on other ports of this machine share a browser's cookies.
std::string CookieName(const mg_connection* connection, const std::string& what) {
  const std::string port = std::to_string(mg_get_request_info(connection)->server_port);
  return (SiteOf(connection).certificate ? "__Host-" : "") + what + "-" + port;
}
std::string SessionName(const mg_connection* connection) { return CookieName(connection, "rigcal"); }
std::string FormName(const mg_connection* connection) { return CookieName(connection, "rigcal-form"); }
std::string KnownName(const mg_connection* connection) { return CookieName(connection, "rigcal-known"); }

bool IsSecure(const mg_connection* connection) {
  return SiteOf(connection).certificate || HeaderOf(connection, "Origin").substr(0, 8) == "https://";
}

std::pair<std::string, std::string> SetCookie(const mg_connection* connection, const std::string& name,
                                              const std::string& value) {
  return {"Set-Cookie", CookieText(name, value, IsSecure(connection))};
}

std::string SecretIn(const mg_connection* connection, const std::string& name) {
  const std::string secret = CookieOf(HeaderOf(connection, "Cookie"), name);
  const bool is_one =
      secret.size() == kSecretBytes && secret.find_first_not_of("0123456789abcdef") == std::string::npos;
  return is_one ? secret : "";
}

std::string PeerText(const mg_connection* connection) {
  const mg_request_info& request = *mg_get_request_info(connection);
  std::vector<std::string_view> forwarded_for;
  for (int i = 0; i < request.num_headers; ++i)
    if (mg_strcasecmp(request.http_headers[i].name, "X-Forwarded-For") == 0)
      forwarded_for.emplace_back(request.http_headers[i].value);
  return ClientAddress(request.remote_addr, SiteOf(connection).proxy, forwarded_for);
}

// Its forms tell where they come from, which the policy of the other pages keeps them from.
int SendLoginPage(mg_connection* connection, int status, const std::string& page, Headers headers) {
  headers.emplace_back("Referrer-Policy", "same-origin");
  return SendOnce(connection, status, page, "text/html; charset=utf-8", headers);
}

int SendForm(mg_connection* connection, int status, LoginPage page, Headers headers = {}) {
  const std::string had = SecretIn(connection, FormName(connection));
  page.form_token = had.empty() ? NewSecret() : had;
  headers.push_back(SetCookie(connection, FormName(connection), page.form_token));
  return SendLoginPage(connection, status, WriteLoginPage(page), std::move(headers));
}

// Of the forms of somebody who is logged in.
std::string FormTokenOf(const std::string& session_secret) { return HmacSha256(session_secret, "rigcal form").str(); }

int ShowLogin(mg_connection* connection, const Visit& visit) {
  if (visit.person && !visit.is_program)
    return SendLoginPage(connection, 200, WriteAccountPage(*visit.person, FormTokenOf(SessionSecretOf(connection))),
                         {});
  const char* const query = mg_get_request_info(connection)->query_string;
  const auto asked = ReadForm(query != nullptr ? query : "");
  return SendForm(connection, 200, {"", OwnPath(asked ? FieldOf(*asked, "next") : "/"), "", ""});
}

int SendMethods(mg_connection* connection, const std::string& allowed) {
  return SendError(
      connection, 405,
      {ErrorCode::kInvalidInput, std::string(mg_get_request_info(connection)->request_method) + " is not answered here",
       "Use " + allowed},
      false, {{"Allow", allowed}});
}

int SendOtherSite(mg_connection* connection) {
  return SendError(connection, 403,
                   {ErrorCode::kInvalidInput, "this form was not sent from a page of this server",
                    "Open /login and send it from there"},
                   false);
}

void EndOld(const mg_connection* connection) {
  const std::string old = SessionSecretOf(connection);
  if (old.empty()) return;
  if (const Status ended = Guarded("a logout", [&] { return SiteOf(connection).logins.end(old); }); !ended)
    LogError(ended.error());
}

// By which this browser is known as one in which `name` logged in; empty: it is not.
std::string KnownMark(const mg_connection* connection, const std::string& name) {
  const std::string mark = SecretIn(connection, KnownName(connection));
  return SiteOf(connection).known->Has(mark, name) ? mark : "";
}

// Kept when the browser ends. One that has a mark keeps it: another would give it more tries.
std::pair<std::string, std::string> SetKnown(const mg_connection* connection, const std::string& name) {
  const std::string has = KnownMark(connection, name);
  auto header =
      SetCookie(connection, KnownName(connection), has.empty() ? SiteOf(connection).known->MarkFor(name) : has);
  header.second += "; Max-Age=31536000";
  return header;
}

int SendLoggedIn(mg_connection* connection, const std::string& secret, const LoginPage& page) {
  EndOld(connection);
  SendHead(connection, 303, 0,
           {{"Location", page.next},
            {"Cache-Control", "no-store"},
            SetCookie(connection, SessionName(connection), secret),
            SetKnown(connection, page.name),
            SetCookie(connection, FormName(connection), "")});
  return 303;
}

int SendWrong(mg_connection* connection, LoginPage page) {
  LogWarn("a login as " + Quoted(page.name) + " from " + PeerText(connection) +
          " was refused: no such name with this password");
  page.what_is_wrong = "There is no such name with this password.";
  return SendForm(connection, 403, std::move(page));
}

int SendTooOften(mg_connection* connection, LoginPage page) {
  const std::string peer = PeerText(connection);
  if (const int count = SiteOf(connection).throttle->CountToTell(peer, std::chrono::steady_clock::now()); count > 0)
    LogWarn(std::to_string(count) + (count == 1 ? " login" : " logins") + " from " + peer + ", the last as " +
            Quoted(page.name) + ", not looked at: too many tries; more of the next minute will be counted");
  page.what_is_wrong = "Too many tries: wait a quarter of a minute, then try again.";
  return SendForm(connection, 429, std::move(page), {{"Retry-After", "15"}});
}

// Whether it may be tried on account of what this browser has left of its own.
bool MayTryAsKnown(const mg_connection* connection, const std::string& name) {
  const std::string mark = KnownMark(connection, name);
  return !mark.empty() && SiteOf(connection).throttle->TryKnown(mark, std::chrono::steady_clock::now());
}

int TryLogin(mg_connection* connection, const Form& form) {
  const Site& site = SiteOf(connection);
  const LoginPage page{"", OwnPath(FieldOf(form, "next")), FieldOf(form, "name").substr(0, limits::kNameMax), ""};
  const std::string peer = PeerText(connection);
  const bool is_known = MayTryAsKnown(connection, page.name);
  if (!is_known && !site.throttle->Try(peer, page.name, std::chrono::steady_clock::now()))
    return SendTooOften(connection, page);
  const auto secret = Guarded("a login", [&] { return site.logins.begin(page.name, FieldOf(form, "password")); });
  if (!secret) {
    if (!is_known) site.throttle->GiveBack(peer, page.name);
    return SendError(connection, 503, secret.error(), false, {{"Retry-After", "2"}});
  }
  if (!*secret) return SendWrong(connection, page);
  if (!is_known) site.throttle->WasRight(peer);
  LogInfo(page.name + " logged in from " + peer);
  return SendLoggedIn(connection, **secret, page);
}

// The form that a page of ours sent, nothing where that is broken; else the status with which it was answered.
tl::expected<std::optional<Form>, int> ReadSentForm(mg_connection* connection) {
  if (!IsFromHere(connection)) return tl::unexpected(SendOtherSite(connection));
  const auto body = ReadBody(connection, "application/x-www-form-urlencoded", kLoginBytesMax);
  if (!body) return tl::unexpected(SendError(connection, body.error().status, body.error().error, false));
  return ReadForm(*body);
}

int LogIn(mg_connection* connection) {
  const auto sent = ReadSentForm(connection);
  if (!sent) return sent.error();
  const std::optional<Form>& form = *sent;
  const std::string token = SecretIn(connection, FormName(connection));
  if (!form || token.empty() || !IsSameSecret(FieldOf(*form, "form"), token))
    return SendForm(connection, 403,
                    {"", form ? OwnPath(FieldOf(*form, "next")) : "/", "",
                     "The page was too old, or the browser takes no cookies: try again."});
  return TryLogin(connection, *form);
}

}  // namespace

bool IsFromHere(const mg_connection* connection) {
  return IsOwnPage(HeaderOf(connection, "Origin"), HeaderOf(connection, "Host"),
                   HeaderOf(connection, "Sec-Fetch-Site"));
}

bool HasFormToken(const mg_connection* connection, const std::string& token) {
  const std::string secret = SessionSecretOf(connection);
  return !secret.empty() && IsSameSecret(token, FormTokenOf(secret));
}

std::string SessionSecretOf(const mg_connection* connection) { return SecretIn(connection, SessionName(connection)); }

int AnswerLogin(mg_connection* connection, const Visit& visit) {
  const std::string_view method = mg_get_request_info(connection)->request_method;
  if (method == "GET" || method == "HEAD") return ShowLogin(connection, visit);
  return method == "POST" ? LogIn(connection) : SendMethods(connection, "GET, HEAD, POST");
}

int AnswerLogout(mg_connection* connection, const Visit& visit) {
  if (std::string_view(mg_get_request_info(connection)->request_method) != "POST")
    return SendMethods(connection, "POST");
  const auto form = ReadSentForm(connection);
  if (!form) return form.error();
  if (visit.person && !(*form && HasFormToken(connection, FieldOf(**form, "form")))) return SendOtherSite(connection);
  EndOld(connection);
  if (visit.person) LogInfo(visit.person->name + " logged out");
  SendHead(connection, 303, 0,
           {{"Location", "/login"}, {"Cache-Control", "no-store"}, SetCookie(connection, SessionName(connection), "")});
  return 303;
}

}  // namespace rigcal::http
