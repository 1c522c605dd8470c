#include "server/http/orders.h"

#include "server/base/limits.h"
#include "server/base/log.h"
#include "server/http/error_body.h"
#include "server/http/guarded.h"
#include "server/http/logins/login_acts.h"
#include "server/http/logins/request_body.h"
#include "server/http/reply.h"
#include "server/http/site.h"

namespace rigcal::http {
namespace {

constexpr std::string_view kApi = "/api/v1/";

int Refuse(mg_connection* connection, int status, const Error& error) {
  return SendError(connection, status, error, true);
}

// Not where it came with a token: no other site's page can make a browser send one.
bool MayBeForged(const mg_connection* connection, const Visit& visit) {
  return !visit.is_program &&
         !(IsFromHere(connection) && HasFormToken(connection, std::string(HeaderOf(connection, "X-Rigcal-Form"))));
}

int Give(mg_connection* connection, const std::string& verb, const Person& person) {
  const auto body = ReadBody(connection, "application/json", limits::kRequestBytesMax);
  if (!body) return Refuse(connection, body.error().status, body.error().error);
  const auto done = Guarded("the order " + verb, [&] { return SiteOf(connection).orders.give(verb, *body, person); });
  if (!done)
    return Refuse(connection, done.error().code == ErrorCode::kConflict ? 409 : StatusOf(done.error().code),
                  done.error());
  return SendOnce(connection, 200, *done, "application/json; charset=utf-8");
}

}  // namespace

std::optional<int> AnswerOrder(mg_connection* connection, const std::string& path, const Visit& visit) {
  const Orders& orders = SiteOf(connection).orders;
  const bool is_post = std::string_view(mg_get_request_info(connection)->request_method) == "POST";
  if (!is_post || !visit.person || path.rfind(kApi, 0) != 0 || !orders.role_of) return std::nullopt;
  const std::string verb = path.substr(kApi.size());
  const auto role = orders.role_of(verb);
  if (!role) return std::nullopt;
  if (!MayActAs(visit.person->role, *role)) {
    LogWarn("order '" + verb + "' of " + visit.person->name + " was refused: it takes the role " + NameOf(*role));
    return Refuse(connection, 403,
                  {ErrorCode::kInvalidInput,
                   verb + " takes the role " + NameOf(*role) + ", and " + visit.person->name + " is " +
                       NameOf(visit.person->role),
                   "Ask somebody who has it, or whoever keeps this server for it: `rigcal user role`"});
  }
  if (MayBeForged(connection, visit))
    return Refuse(connection, 403,
                  {ErrorCode::kInvalidInput, "this order was not sent from a page of this server",
                   "Programs take a token: `rigcal token new`"});
  return Give(connection, verb, *visit.person);
}

}  // namespace rigcal::http
