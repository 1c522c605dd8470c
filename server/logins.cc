#include "server/logins.h"

#include <chrono>
#include <memory>
#include <semaphore>

#include "server/base/digests/password.h"
#include "server/base/digests/secret.h"
#include "server/base/digests/sha256.h"
#include "server/formats/answers/parameters.h"
#include "server/pipeline/orders/orders.h"
#include "server/thread_store.h"
#include "storage/access/access_tokens.h"
#include "storage/access/accounts.h"
#include "storage/access/login_sessions.h"

namespace rigcal {
namespace {

using http::Person;

// Each takes 32 MiB and a processor.
constexpr int kPasswordsAtOnce = 2;
constexpr std::chrono::seconds kPasswordWithin{2};

Result<std::optional<Person>> OfSession(const storage::StorePlace& place, const Clock& clock,
                                        const std::string& secret) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
  RIGCAL_ASSIGN(const auto account, storage::SeeLogin(*store, Sha256Of(secret), clock.Now()));
  return account ? std::optional(Person{account->name, account->role}) : std::nullopt;
}

Result<std::optional<Person>> OfToken(const storage::StorePlace& place, const std::string& secret) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
  RIGCAL_ASSIGN(const auto token, storage::LoadAccessToken(*store, Sha256Of(secret)));
  return token ? std::optional(Person{token->name, token->role, token->robots}) : std::nullopt;
}

// The time does not tell whether there is such a name.
bool IsRight(const std::optional<Account>& account, const std::string& password) {
  if (account) return IsPassword(password, account->password_hash);
  SpendTimeOfPassword(password);
  return false;
}

Result<std::optional<std::string>> Begin(const storage::StorePlace& place, const Clock& clock, const std::string& name,
                                         const std::string& password) {
  if (password.size() > kPasswordBytesMax) return std::optional<std::string>();
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
  RIGCAL_ASSIGN(const auto account, storage::LoadAccount(*store, name));
  if (!IsRight(account, password)) return std::optional<std::string>();
  std::string secret = NewSecret();
  RIGCAL_TRY(storage::BeginLogin(*store, Sha256Of(secret), *account, clock.Now()));
  return std::optional(std::move(secret));
}

Status End(const storage::StorePlace& place, const std::string& secret) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
  return storage::EndLogin(*store, Sha256Of(secret));
}

Result<bool> AreNeeded(const storage::StorePlace& place) {
  RIGCAL_ASSIGN(storage::Store* const store, StoreOfThread(place));
  return storage::HasAccounts(*store);
}

using Places = std::counting_semaphore<kPasswordsAtOnce>;
struct FreesPlace {
  void operator()(Places* places) const { places->release(); }
};

}  // namespace

http::Logins LoginsOf(const storage::StorePlace& place, const Clock& clock, bool always) {
  http::Logins logins;
  logins.are_needed = [place, always]() -> Result<bool> { return always ? Result<bool>(true) : AreNeeded(place); };
  logins.of_session = [place, &clock](const std::string& secret) { return OfSession(place, clock, secret); };
  logins.of_token = [place](const std::string& secret) { return OfToken(place, secret); };
  logins.end = [place](const std::string& secret) { return End(place, secret); };
  const auto places = std::make_shared<Places>(kPasswordsAtOnce);
  logins.begin = [place, &clock, places](const std::string& name,
                                         const std::string& password) -> Result<std::optional<std::string>> {
    if (!places->try_acquire_for(kPasswordWithin))
      return Fail(ErrorCode::kBusy, "others are logging in", "Try again in some seconds.");
    const std::unique_ptr<Places, FreesPlace> taken(places.get());
    return Begin(place, clock, name, password);
  };
  return logins;
}

namespace {

Result<std::string> AsGivenBy(const std::string& who, const std::string& json) {
  RIGCAL_ASSIGN(const auto parameters, formats::Parameters::Read(json));
  if (parameters.Text("who").value_or(who) == who) return formats::WithParameter(json, "who", who);
  return Fail(ErrorCode::kInvalidInput, "the order says another `who` than " + who + ", who gives it",
              "Leave `who` out.");
}

}  // namespace

http::Orders OrdersTo(const ServiceRelay& relay) {
  http::Orders orders;
  orders.role_of = pipeline::RoleOfOrder;
  orders.give = [&relay](const std::string& verb, const std::string& json,
                         const Person& person) -> Result<std::string> {
    RIGCAL_ASSIGN(const std::string order, AsGivenBy(person.name, json));
    return relay.GiveOrder(verb, order);
  };
  return orders;
}

}  // namespace rigcal
