#include "server/pipeline/orders/channel.h"

#include "server/base/log.h"
#include "server/formats/answers/parameters.h"
#include "server/model/approval/decision.h"
#include "server/pipeline/orders/orders.h"
#include "storage/access/accounts.h"

namespace rigcal::pipeline {

namespace {

Result<std::string> WithVerified(const std::string& json, const std::string& name) {
  RIGCAL_ASSIGN(const auto parameters, formats::Parameters::Read(json));
  const std::string who = parameters.Text("who").value_or(name);
  if (who != name)
    return Fail(ErrorCode::kInvalidInput, "an order by '" + who + "' came with the identity of operator " + name,
                "Leave --by out: who gives an order is whose identity it comes with.");
  RIGCAL_TRY(CheckPerson(name));
  return formats::WithParameter(json, "who", name + kVerified);
}

}  // namespace

Status CheckMayGive(const std::string& verb, const OrderOrigin& origin) {
  const auto needed = RoleOfOrder(verb);
  if (!origin.verified || !needed || MayActAs(origin.verified->role, *needed)) return {};
  Error error{
      ErrorCode::kInvalidInput,
      "the identity of " + origin.verified->name + ", " + NameOf(origin.verified->role) + ", does not let them " + verb,
      "Ask somebody whose identity has the role " + NameOf(*needed) + " (`rigcal identity new operator NAME --role " +
          NameOf(*needed) + "`)."};
  Log(LogLevel::kWarn, {.event = "refusal", .kind = NameOf(error.code)}, error.what);
  return Fail(std::move(error));
}

Result<std::string> WithChannel(storage::Store& store, const std::string& json, const OrderOrigin& origin) {
  if (origin.verified) return WithVerified(json, origin.verified->name);
  RIGCAL_ASSIGN(const bool has_users, storage::HasAccounts(store));
  if (origin.channel == OrderChannel::kHttp || !has_users) return json;
  RIGCAL_ASSIGN(const auto parameters, formats::Parameters::Read(json));
  const std::string who = parameters.Text("who").value_or("");
  if (who.find_first_not_of(' ') == std::string::npos) return json;  // it is refused, as without users
  RIGCAL_TRY(CheckPerson(who));
  return formats::WithParameter(json, "who", who + kNotVerified);
}

}  // namespace rigcal::pipeline
