#include "server/pipeline/orders/channel.h"

#include "server/formats/answers/parameters.h"
#include "server/model/approval/decision.h"
#include "storage/access/accounts.h"

namespace rigcal::pipeline {

Result<std::string> WithChannel(storage::Store& store, const std::string& json, OrderChannel channel) {
  RIGCAL_ASSIGN(const bool has_users, storage::HasAccounts(store));
  if (channel == OrderChannel::kHttp || !has_users) return json;
  RIGCAL_ASSIGN(const auto parameters, formats::Parameters::Read(json));
  const std::string who = parameters.Text("who").value_or("");
  if (who.find_first_not_of(' ') == std::string::npos) return json;  // it is refused, as without users
  RIGCAL_TRY(CheckPerson(who));
  return formats::WithParameter(json, "who", who + kNotVerified);
}

}  // namespace rigcal::pipeline
